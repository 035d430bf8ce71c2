import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from physgnn.geometry.image import ImageGrid
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging.voxel_fields import rasterize


def test_a_linear_field_is_exact_in_any_image(
    block: TetMesh, oblique: ImageGrid
) -> None:
    rng = np.random.default_rng(1)
    A, b = rng.normal(size=(2, 3)), rng.normal(size=2)
    values = block.points @ A.T + b
    field, cell = rasterize(block.points, block.cells, values, oblique)
    world = oblique.to_world(np.moveaxis(np.indices(oblique.shape), 0, -1))
    inside = ((world > 0) & (world < 10)).all(axis=-1)
    np.testing.assert_array_equal(cell >= 0, inside)
    np.testing.assert_allclose(field[inside], world[inside] @ A.T + b, atol=1e-9)
    assert (field[~inside] == 0).all()


def test_each_voxel_names_the_cell_that_holds_it(
    block: TetMesh, oblique: ImageGrid
) -> None:
    _, cell = rasterize(block.points, block.cells, np.empty((64, 0)), oblique)
    index = np.argwhere(cell >= 0)
    corners = block.points[block.cells[cell[tuple(index.T)]]]
    edges = np.moveaxis(corners[:, 1:] - corners[:, :1], 1, 2)
    offset = oblique.to_world(index) - corners[:, 0]
    weights = np.linalg.solve(edges, offset[..., None])[..., 0]
    assert weights.min() > -1e-6 and weights.sum(axis=1).max() < 1 + 1e-6


@given(st.integers(0, 2**32 - 1))
def test_no_voxel_is_lost_between_cells(seed: int) -> None:
    """A star of cells around a random point fills their hull."""
    rng = np.random.default_rng(seed)
    corners = np.array([[0.0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]])
    points = np.vstack([corners, rng.dirichlet(np.ones(4)) @ corners])
    cells = np.array([[4, 1, 2, 3], [0, 4, 2, 3], [0, 1, 4, 3], [0, 1, 2, 4]])
    grid = ImageGrid((10, 10, 10), np.eye(4))
    _, cell = rasterize(points, cells.astype(np.int32), points, grid)
    total = np.indices((10, 10, 10)).sum(axis=0)
    np.testing.assert_array_equal(cell >= 0, total <= 9)


def test_a_cell_turned_inside_out_is_left_out() -> None:
    points = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]])
    right = np.array([[0, 1, 2, 3]], dtype=np.int32)
    for flip, n_inside in ((1.0, 35), (-1.0, 15)):
        grid = ImageGrid((6, 6, 6), np.diag([flip, 1.0, 1.0, 1.0]))
        _, cell = rasterize(points, right[:, [0, 2, 1, 3]], points, grid)
        assert (cell == -1).all()
        _, cell = rasterize(points, right, points, grid)
        assert (cell == 0).sum() == n_inside

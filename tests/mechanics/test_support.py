import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh, without_unused_points
from physgnn.mechanics import Body, NeoHookean
from physgnn.mechanics.support import check_held

BLOCK = block_mesh(2)


def two_blocks(step: tuple[float, float, float]) -> TetMesh:
    """Two blocks whose coinciding points are one."""
    points = np.concatenate([BLOCK.points, BLOCK.points + step]).round(9)
    cells = np.concatenate([BLOCK.cells, BLOCK.cells + BLOCK.n_points])
    merged, index = np.unique(points, axis=0, return_inverse=True)
    region = np.zeros(len(cells), dtype=np.int32)
    return TetMesh(merged, index.reshape(-1)[cells].astype(np.int32), region)


def bottom(mesh: TetMesh) -> np.ndarray:
    return np.flatnonzero((mesh.points[:, 2] == 0) & (mesh.points[:, 0] <= 10))


def test_a_block_that_shares_a_face_is_held_with_the_other() -> None:
    mesh = two_blocks((10.0, 0.0, 0.0))
    check_held(mesh, bottom(mesh))


@pytest.mark.parametrize(
    "step",
    [(10.0, 0.0, 10.0), (10.0, 10.0, 10.0), (30.0, 0.0, 0.0)],
    ids=["sharing an edge", "sharing a point", "apart"],
)
def test_a_block_that_shares_no_face_is_refused(step) -> None:  # type: ignore[no-untyped-def]
    mesh = two_blocks(step)
    with pytest.raises(InputError, match=r"1 of its 2 parts can move; .* 48 cells"):
        check_held(mesh, bottom(mesh))
    far = np.flatnonzero((mesh.points >= np.array(step) - 1e-9).all(axis=1))
    check_held(mesh, np.union1d(bottom(mesh), far))


def test_points_in_line_hold_nothing() -> None:
    line = np.flatnonzero((BLOCK.points[:, 1] == 0) & (BLOCK.points[:, 2] == 0))
    assert len(line) == 3
    with pytest.raises(InputError, match="not in line"):
        check_held(BLOCK, line)
    check_held(BLOCK, np.append(line, BLOCK.n_points - 1))


def test_a_part_held_by_a_part_that_is_held() -> None:
    """Three single cells in a row, each sharing three points but no face."""
    first = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    mesh = TetMesh(
        np.array([*first, [1, 1, 1], [2, 0, 0]], dtype=float),
        np.array([[0, 1, 2, 3], [1, 5, 4, 3]]),
        np.zeros(2),
    )
    with pytest.raises(InputError, match="1 of its 2 parts"):
        check_held(mesh, np.array([0, 1, 2]))
    check_held(mesh, np.array([0, 1, 2, 4]))


def test_halves_whose_points_were_not_merged_are_refused() -> None:
    upper = BLOCK.points[BLOCK.cells].mean(axis=1)[:, 2] > 5.0
    cells = BLOCK.cells + BLOCK.n_points * upper[:, None]
    mesh, _ = without_unused_points(
        np.concatenate([BLOCK.points, BLOCK.points]), cells, BLOCK.region,
        dict(BLOCK.point_sets),
    )  # fmt: skip
    materials = dict.fromkeys((0, 1), NeoHookean(3000.0, 0.45))
    with pytest.raises(InputError, match="merge points that coincide"):
        Body(mesh, materials)

import numpy as np
import pytest

from imaging.conftest import rigid
from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging import (
    forward_field,
    grid_around,
    inverse_field,
    round_trip_mm,
)


def test_a_rotation_and_its_inverse_are_exact(
    block: TetMesh, oblique: ImageGrid
) -> None:
    u = rigid(block, (5, -8, 12), (0.3, -0.5, 0.4))
    world = oblique.to_world(np.moveaxis(np.indices(oblique.shape), 0, -1))
    forward = forward_field(block, u, oblique)
    inverse = inverse_field(block, u, oblique)
    there = (world + forward.vectors)[forward.inside]
    expected = np.linalg.lstsq(
        np.column_stack([block.points, np.ones(block.n_points)]), block.points + u
    )[0]
    rest = world[forward.inside]
    np.testing.assert_allclose(there, rest @ expected[:3] + expected[3], atol=1e-9)
    back = (world + inverse.vectors)[inverse.inside]
    deformed = world[inverse.inside]
    np.testing.assert_allclose(back @ expected[:3] + expected[3], deformed, atol=1e-9)


def test_round_trip_of_a_strong_deformation() -> None:
    from meshes import block_mesh

    mesh = block_mesh(8, side=80.0, jitter=0.2)
    x, y, z = (mesh.points / 80.0).T
    u = 12.0 * (z * np.sin(np.pi * x) * np.sin(np.pi * y))[:, None] * [0.3, 0.2, -1.0]
    grid = grid_around(mesh, spacing_mm=1.0, margin_mm=20.0)
    forward, inverse = (make(mesh, u, grid) for make in (forward_field, inverse_field))
    error = round_trip_mm(forward, inverse)
    assert len(error) > 0.9 * inverse.inside.sum()
    assert error.max() < 0.1 and error.mean() < 0.01


def test_the_extension_fades_and_joins(block: TetMesh) -> None:
    grid = grid_around(block, spacing_mm=0.5, margin_mm=15.0)
    u = np.tile([0.0, 0.0, 2.0], (block.n_points, 1))
    field = forward_field(block, u, grid, fade_mm=10.0)
    assert field.fade_mm == 10.0
    column = grid.to_index(np.array([[5.0, 5.0, 0.0]]))[0].round().astype(int)
    line = field.vectors[column[0], column[1], :, 2]
    z = grid.to_world(
        np.column_stack([np.tile(column[:2], (len(line), 1)), np.arange(len(line))])
    )[:, 2]
    top = z[field.inside[column[0], column[1]]].max()
    np.testing.assert_allclose(
        line[z > top], np.clip(2.0 * (1 - (z[z > top] - top) / 10.0), 0, None)
    )
    assert np.abs(np.diff(line)).max() <= 2.0 * 0.5 / 10.0 + 1e-12


def test_wrong_input_is_refused(block: TetMesh, oblique: ImageGrid) -> None:
    with pytest.raises(InputError, match="one vector a point"):
        forward_field(block, np.zeros((3, 3)), oblique)
    far = ImageGrid((4, 4, 4), np.diag([1.0, 1.0, 1.0, 1.0]) + 0.0)
    moved = far.affine.copy()
    moved[:3, 3] = 500.0
    with pytest.raises(InputError, match="do not meet"):
        inverse_field(block, np.zeros_like(block.points), ImageGrid((4, 4, 4), moved))
    with pytest.raises(InputError, match="fade_mm"):
        forward_field(block, np.zeros_like(block.points), oblique, fade_mm=0.0)

import numpy as np
import pytest

from physgnn.geometry import (
    TetMesh,
    boundary_faces,
    boundary_points,
    boundary_surface,
    volume,
)


def test_one_cell_has_four_outward_faces() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    mesh = TetMesh(points, np.array([[0, 1, 2, 3]]), np.array([0]))
    assert len(boundary_faces(mesh)) == 4
    assert volume(boundary_surface(mesh)) == pytest.approx(1 / 6)


def test_boundary_encloses_the_cells(block: TetMesh) -> None:
    assert len(boundary_faces(block)) == 6 * 2 * 3**2
    assert volume(boundary_surface(block)) == pytest.approx(block.cell_volumes.sum())


def test_region_interface_is_not_outside(block: TetMesh) -> None:
    on_box = ((block.points == 0.0) | (block.points == 10.0)).any(axis=1)
    np.testing.assert_array_equal(boundary_points(block), np.flatnonzero(on_box))

"""Image-based registrations recover what moved, and find nothing where nothing did."""

import numpy as np
import pytest

from brain_block import CORNER, SIDE, VOXEL, bump
from physgnn.evaluation.in_silico.image_peers import IMAGE_METHODS
from physgnn.evaluation.in_silico.simulated_images import (
    INTRAOPERATIVE,
    PREOPERATIVE,
    Scan,
    simulated_scan,
)
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.tetmesh import TetMesh


@pytest.fixture(scope="module")
def before(brain: TetMesh, grid: ImageGrid) -> Scan:
    return simulated_scan(brain, np.zeros_like(brain.points), grid, PREOPERATIVE)


@pytest.fixture(scope="module")
def inside(brain: TetMesh) -> np.ndarray:
    """Which points of the mesh are not of its surface."""
    return (np.abs(brain.points - CORNER - SIDE / 2) < SIDE / 2 - 1.0).all(axis=1)


@pytest.mark.parametrize("name", IMAGE_METHODS)
def test_a_known_displacement_is_recovered_in_another_contrast(
    name: str, brain: TetMesh, grid: ImageGrid, before: Scan, inside: np.ndarray
) -> None:
    u = bump(brain.points, 6.0)
    after = simulated_scan(brain, u, grid, INTRAOPERATIVE, seed=1)
    found = IMAGE_METHODS[name](before, after, brain.points)
    error = np.linalg.norm(found - u, axis=1)[inside]
    size = np.linalg.norm(u, axis=1)[inside]
    assert error.mean() < VOXEL < size.max()
    assert error.mean() < 0.5 * size.mean()


# splines see a few voxels alone, and noise that is the same in both
@pytest.mark.parametrize(("name", "most_mm"), [("B-spline", 0.5), ("demons", 0.05)])
def test_nothing_moves_between_equal_images(
    name: str, most_mm: float, brain: TetMesh, before: Scan, inside: np.ndarray
) -> None:
    found = IMAGE_METHODS[name](before, before, brain.points)
    assert np.linalg.norm(found, axis=1)[inside].mean() < most_mm

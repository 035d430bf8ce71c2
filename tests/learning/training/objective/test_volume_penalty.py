"""Cells pay for losing their volume, and only then."""

import numpy as np
import pytest
import torch

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.training.objective.volume_penalty import SMALLEST, VolumePenalty
from physgnn.mechanics import deformation_gradient


@pytest.fixture(scope="module")
def moved(block: TetMesh) -> np.ndarray:
    """Rough enough for some cells to be turned inside out."""
    return np.random.default_rng(0).normal(size=(2, *block.points.shape))


def test_volume_ratio_is_the_determinant(block: TetMesh, moved: np.ndarray) -> None:
    expected = [np.linalg.det(deformation_gradient(block, u)) for u in moved]
    found = VolumePenalty(block).volume_ratio(torch.tensor(moved, dtype=torch.float32))
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-4)


def test_sound_cells_cost_nothing(block: TetMesh) -> None:
    stretch = torch.tensor(0.2 * block.points, dtype=torch.float32)
    assert float(VolumePenalty(block)(stretch[None])) == 0.0


def test_going_down_the_cost_turns_cells_back(
    block: TetMesh, moved: np.ndarray
) -> None:
    penalty = VolumePenalty(block)
    u = torch.tensor(moved, dtype=torch.float32, requires_grad=True)
    before = int((penalty.volume_ratio(u) <= 0).sum())
    assert before > 5
    optimiser = torch.optim.Adam([u], lr=0.05)
    for _ in range(200):
        optimiser.zero_grad()
        penalty(u).backward()
        optimiser.step()
    assert float(penalty.volume_ratio(u).min().detach()) > SMALLEST / 2

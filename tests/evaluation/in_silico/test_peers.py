"""Rigid motions and splines find what they can say exactly."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from physgnn.arrays import FloatArray
from physgnn.evaluation.in_silico.peers import (
    nearest_pairs,
    rigid,
    rigid_icp,
    spline,
)
from physgnn.geometry.measured import PointPairs, SurfacePoints

TURN = Rotation.from_rotvec([0.02, -0.03, 0.01])
OFFSET = np.array([1.0, -2.0, 0.5])


@pytest.fixture
def cap() -> FloatArray:
    """Points of a bumpy cap."""
    rng = np.random.default_rng(0)
    across = rng.uniform(-30.0, 30.0, (1500, 2))
    height = 6.0 * np.cos(across[:, 0] / 8.0) + 4.0 * np.sin(across[:, 1] / 6.0)
    return np.column_stack([across, height])


def test_a_rigid_motion_is_found_exactly(cap: FloatArray) -> None:
    pairs = PointPairs(cap[:20], TURN.apply(cap[:20]) + OFFSET)
    moved = TURN.apply(cap) + OFFSET - cap
    np.testing.assert_allclose(rigid(pairs, cap), moved, atol=1e-9)


def test_a_rigid_motion_is_found_by_matching(cap: FloatArray) -> None:
    measured = SurfacePoints((TURN.apply(cap) + OFFSET)[::3])
    moved = TURN.apply(cap) + OFFSET - cap
    found = rigid_icp(measured, cap, cap)
    left = np.linalg.norm(found - moved, axis=1).mean()
    assert left < 0.2 * np.linalg.norm(moved, axis=1).mean()


def test_pairs_are_of_the_nearest_points(cap: FloatArray) -> None:
    pairs = nearest_pairs(SurfacePoints(cap[:50] + 1e-3), cap)
    np.testing.assert_array_equal(pairs.source, cap[:50])
    np.testing.assert_array_equal(pairs.target, cap[:50] + 1e-3)


def test_a_spline_says_an_affine_map_exactly_and_keeps_its_anchors(
    cap: FloatArray,
) -> None:
    gradient = 0.05 * np.random.default_rng(1).normal(size=(3, 3))
    pairs = PointPairs(cap[:60], cap[:60] + cap[:60] @ gradient + OFFSET)
    far = 3.0 * cap[100:140]
    np.testing.assert_allclose(spline(pairs, far), far @ gradient + OFFSET, atol=1e-5)
    anchors = cap[200:230] - [0.0, 0.0, 80.0]
    there = spline(pairs, anchors, anchors)
    free = spline(pairs, anchors)
    assert np.abs(there).max() < 0.05 * np.abs(free).max()

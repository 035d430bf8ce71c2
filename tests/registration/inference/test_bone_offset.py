"""A rigid motion from points that do not move with a brain, and how far it is known."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from physgnn.geometry.measured import BonePoints
from physgnn.registration.fit import bone_fit_of
from physgnn.registration.inference.bone_offset import BoneOffset, offset_from_bone

NOISE = 0.5
# around a block of 100 mm
AROUND = np.array(
    [
        [-6.0, 20, 80],
        [106, 30, 95],
        [50, -7, 70],
        [45, 107, 90],
        [-8, 90, 30],
        [80, 60, 108],
    ]
)
PLACES = np.array([[50.0, 50, 100], [20, 70, 90], [60, 40, 30]])


def motion(seed: int, mm: float = 8.0, radians: float = 0.1):
    rng = np.random.default_rng(seed)
    turn = Rotation.from_rotvec(radians * rng.normal(size=3))
    away = mm * rng.normal(size=3)
    return lambda points: turn.apply(points - PLACES[0]) + PLACES[0] + away


def noisy(seed: int, count: int = 6) -> tuple[BoneOffset, np.ndarray]:
    """An offset from noisy points, and where places truly are with it."""
    move, rng = motion(seed), np.random.default_rng(seed + 1000)
    target = move(AROUND[:count]) + NOISE * rng.normal(size=(count, 3))
    return offset_from_bone(BonePoints(AROUND[:count], target), NOISE), move(PLACES)


@pytest.mark.parametrize("count", [3, 6])
@pytest.mark.parametrize("radians", [0.0, 0.02, 0.4])
def test_exact_points_tell_the_exact_motion(count: int, radians: float) -> None:
    move = motion(1, radians=radians)
    found = offset_from_bone(BonePoints(AROUND[:count], move(AROUND[:count])), NOISE)
    np.testing.assert_allclose(found.motion(PLACES), move(PLACES), atol=1e-9)
    np.testing.assert_allclose(found.motion.undone(move(PLACES)), PLACES, atol=1e-9)
    fit = bone_fit_of(found)
    assert fit.misfit_mm < 1e-9 and fit.n_points == count
    assert not [*fit.too_few(), *fit.contradictions()]


def test_errors_have_the_covariance_that_is_promised() -> None:
    """Their squares over it are of chi-square, 3 on average, at and far from bone."""
    squares = []
    for seed in range(150):
        found, truly = noisy(seed)
        error = found.motion(PLACES) - truly
        for e, place in zip(error, PLACES, strict=True):
            root = found.prior_about(place).axes
            C = (root @ root.T)[:3, :3]
            squares.append(e @ np.linalg.solve(C, e))
    # of 150 motions: 3 +- 0.2, and a little more for what the weights cost
    assert 2.5 < np.mean(squares) < 3.9


def test_a_centre_is_a_choice() -> None:
    """What is known of a place does not depend on about what it turns."""
    found, _ = noisy(0)
    variances = []
    for centre in (PLACES[0], np.array([-30.0, 200.0, 10.0])):
        root = found.prior_about(centre).axes
        arm = PLACES[2] - centre
        turns = np.cross(np.eye(3), arm).T  # a turn about e moves the place by e x arm
        J = np.concatenate([np.eye(3), turns], axis=1)
        variances.append(J @ root @ root.T @ J.T)
    np.testing.assert_allclose(variances[0], variances[1], rtol=1e-6, atol=1e-9)


def test_swapped_and_stray_points_are_named() -> None:
    named = 0
    for seed in range(20):
        move, rng = motion(seed), np.random.default_rng(seed)
        target = move(AROUND) + NOISE * rng.normal(size=AROUND.shape)
        target[2] += 15.0 * rng.normal(size=3)
        found = offset_from_bone(BonePoints(AROUND, target), NOISE)
        named += np.flatnonzero(found.fit.outliers).tolist() == [2]
        assert not [*bone_fit_of(found).contradictions()]
        target[[0, 1]] = target[[1, 0]]
        found = offset_from_bone(BonePoints(AROUND, target), NOISE)
        assert found.fit.outliers[:3].all()
        assert [*bone_fit_of(found).contradictions()]  # half of them are bad
    assert named >= 19


def test_a_line_does_not_tell_a_turn_about_it_and_says_so() -> None:
    line = AROUND[0] + np.linspace(0.0, 1.0, 3)[:, None] * [0.0, 60.0, 10.0]
    move = motion(2, radians=0.05)
    found = offset_from_bone(BonePoints(line, move(line)), NOISE)
    np.testing.assert_allclose(found.motion(line), move(line), atol=1e-9)
    assert "across" in " ".join(bone_fit_of(found).too_few())
    root = found.prior_about(PLACES[0]).axes
    assert np.sqrt(np.linalg.eigvalsh(root @ root.T)[-1]) > 2.0  # mm, at 50 mm from it


def test_one_point_tells_a_translation_and_says_so() -> None:
    away = np.array([1.0, 2.0, 3.0])
    found = offset_from_bone(BonePoints(AROUND[:1], AROUND[:1] + away), NOISE)
    np.testing.assert_allclose(found.motion(PLACES), PLACES + away)
    assert "at least 3" in " ".join(bone_fit_of(found).too_few())


def test_points_that_no_rigid_motion_meets_contradict_each_other() -> None:
    stretched = 1.1 * (AROUND - PLACES[0]) + PLACES[0]
    fit = bone_fit_of(offset_from_bone(BonePoints(AROUND, stretched), NOISE))
    assert [*fit.contradictions()]

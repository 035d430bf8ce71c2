import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.errors import InputError
from physgnn.geometry.measured import PointPairs, SurfacePoints, farthest_points


@given(st.integers(0, 2**32 - 1), st.floats(0.2, 2.0))
def test_all_points_are_near_a_chosen_one_and_those_apart(
    seed: int, spacing: float
) -> None:
    points = np.random.default_rng(seed).normal(size=(60, 3))
    chosen = points[farthest_points(points, spacing=spacing)]
    apart = np.linalg.norm(points[:, None] - chosen[None], axis=2)
    assert apart.min(axis=1).max() <= spacing
    between = np.linalg.norm(chosen[:, None] - chosen[None], axis=2)
    assert (between + np.eye(len(chosen)) * 9).min() > spacing


def test_thinning_keeps_the_count_and_follows_its_points() -> None:
    """Which points are left does not depend on where they lie."""
    points = np.random.default_rng(0).normal(size=(500, 3))
    thin = SurfacePoints(points).thinned(40)
    assert len(thin.points) == 40
    moved = SurfacePoints(2.0 * points[:, ::-1] + 1e-6).thinned(40)
    np.testing.assert_allclose(moved.points, 2.0 * thin.points[:, ::-1], atol=2e-6)
    few = SurfacePoints(points[:12])
    assert few.thinned(40) is few


def test_wrong_points_are_refused() -> None:
    with pytest.raises(InputError, match="10 points or more"):
        SurfacePoints(np.zeros((3, 3)))
    with pytest.raises(InputError, match="finite"):
        SurfacePoints(np.full((12, 3), np.nan))


def test_displacement_is_target_minus_source() -> None:
    source = np.arange(12.0).reshape(4, 3)
    pairs = PointPairs(source, source + np.array([1, 2, 3]))
    np.testing.assert_array_equal(pairs.displacement, np.tile([1, 2, 3], (4, 1)))


@pytest.mark.parametrize(
    ("n_source", "n_target", "value"), [(3, 4, 0.0), (2, 2, 0.0), (3, 3, np.nan)]
)
def test_what_does_not_pair_is_refused(
    n_source: int, n_target: int, value: float
) -> None:
    with pytest.raises(InputError):
        PointPairs(np.full((n_source, 3), value), np.zeros((n_target, 3)))

"""A dent that the body does not follow is found in an area, not in the whole."""

import numpy as np
import pytest

from physgnn.registration.fit import FEWEST_OF_AREA, bump_of

NOISE = 0.8
GRID = np.stack(np.meshgrid(*[np.arange(0.0, 200.0, 8.0)] * 2), axis=-1).reshape(-1, 2)
POINTS = np.column_stack([GRID, np.zeros(len(GRID))])


def misfit(seed: int) -> np.ndarray:
    """Noise, of which a tenth is far off in random directions."""
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal(len(POINTS))
    chosen = rng.choice(len(POINTS), len(POINTS) // 10, replace=False)
    noise[chosen] += 15.0 * rng.choice([-1.0, 1.0], len(chosen))
    return noise


@pytest.mark.parametrize("seed", range(10))
def test_noise_and_bad_points_are_no_dent(seed: int) -> None:
    assert bump_of(POINTS, misfit(seed), np.full(len(POINTS), NOISE)) == 0.0


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_dent_is_as_deep_as_it_is(side: float) -> None:
    away = np.linalg.norm(GRID - 100.0, axis=1)
    dent = 3.0 * side * (away < 25.0)
    found = bump_of(POINTS, misfit(0) + dent, np.full(len(POINTS), NOISE))
    assert found == pytest.approx(3.0 * NOISE, rel=0.3)
    assert np.sqrt((dent**2).mean()) < 1.0  # noise that is as large hides it in all


def test_few_places_tell_nothing() -> None:
    some = slice(FEWEST_OF_AREA - 1)
    assert bump_of(POINTS[some], np.full(9, 9.0), np.full(9, NOISE)) == 0.0

"""The running distribution against NumPy on everything at once."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from physgnn.evaluation.measure.distribution import (
    BIN_EDGES_MM,
    HISTOGRAM_EDGES_MM,
    RESOLUTION,
    SMALLEST_MM,
    RunningDistribution,
)

errors = arrays(
    float, st.integers(1, 300), elements=st.floats(0, 1e3, allow_subnormal=False)
)


@given(errors, st.integers(1, 7))
def test_exact_parts(values: np.ndarray, n_batches: int) -> None:
    running = RunningDistribution()
    for batch in np.array_split(values, n_batches):
        running.add(batch)
    summary = running.summary()
    assert summary is not None
    assert summary.mean == pytest.approx(values.mean())
    assert summary.std == pytest.approx(values.std(), abs=1e-6 * values.max() + 1e-12)
    assert summary.largest == values.max()
    assert summary.within_1mm == np.mean(values <= 1)
    assert running.counts.sum() == len(values)


@pytest.mark.parametrize("seed", range(3))
def test_quantiles_within_their_resolution(seed: int) -> None:
    values = np.random.default_rng(seed).lognormal(-2, 2, size=20000)
    running = RunningDistribution()
    running.add(values)
    for probability in (0.05, 0.5, 0.95, 0.99):
        exact = np.quantile(values, probability)
        assert running.quantile(probability) == pytest.approx(exact, rel=2 * RESOLUTION)


@given(errors)
def test_quantiles_bracket_the_sorted_values(values: np.ndarray) -> None:
    """Within one bin of the value of that rank, whatever the gaps between values."""
    running = RunningDistribution()
    running.add(values)
    for probability in (0.1, 0.5, 0.99):
        rank = max(int(np.ceil(probability * len(values))), 1) - 1
        exact = np.sort(values)[rank]
        found = running.quantile(probability)
        assert abs(found - exact) <= 1.01 * RESOLUTION * exact + SMALLEST_MM


def test_bins_hold_what_their_edges_say() -> None:
    running = RunningDistribution()
    centres = np.sqrt(BIN_EDGES_MM[:-1] * BIN_EDGES_MM[1:])
    running.add(centres)
    assert running.counts[0] == 0
    assert (running.counts[1:] == 1).all()


@given(errors)
def test_histogram_counts_between_its_edges(values: np.ndarray) -> None:
    running = RunningDistribution()
    running.add(values)
    histogram, edges = running.histogram(), np.array(HISTOGRAM_EDGES_MM)
    assert sum(histogram) == len(values)
    assert len(histogram) == len(edges)
    far = (np.abs(values[:, None] / edges - 1) > 1e-9).all(axis=1)  # from any edge
    assert (np.histogram(values[far], edges)[0] <= histogram[1:]).all()


def test_nothing_has_no_summary() -> None:
    running = RunningDistribution()
    running.add([])
    assert running.summary() is None

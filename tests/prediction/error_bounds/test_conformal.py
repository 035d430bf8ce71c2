"""The bound holds as often as it says, for exchangeable samples and for groups."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.prediction.error_bounds.conformal import conformal_quantile


@given(st.integers(20, 200), st.floats(0.5, 0.95), st.integers(0, 2**32 - 1))
def test_ungrouped_is_the_textbook_quantile(n: int, coverage: float, seed: int) -> None:
    """The ⌈(n+1)·coverage⌉-th smallest score (Vovk; Lei et al. 2018)."""
    scores = np.random.default_rng(seed).exponential(size=n)
    bound, reached = conformal_quantile(scores, np.arange(n), coverage)
    rank = int(np.ceil((n + 1) * coverage - 1e-9))
    assert reached == pytest.approx(coverage)
    assert bound == np.sort(scores)[min(rank, n) - 1]


@pytest.mark.parametrize("coverage", [0.8, 0.9])
def test_coverage_on_a_new_group(coverage: float) -> None:
    """Samples of a group share an effect, which pooling them would ignore."""
    rng = np.random.default_rng(0)
    n_trials, n_groups, size = 2000, 19, 10
    held = 0.0
    for _ in range(n_trials):
        effect = rng.lognormal(size=(n_groups + 1, 1))
        scores = effect * rng.lognormal(0, 0.3, size=(n_groups + 1, size))
        groups = np.repeat(np.arange(n_groups), size)
        bound, _ = conformal_quantile(scores[:-1].ravel(), groups, coverage)
        held += (scores[-1] <= bound).mean()
    deviation = np.sqrt(coverage * (1 - coverage) / n_trials)
    assert held / n_trials > coverage - 3 * deviation
    assert held / n_trials < coverage + 0.06


def test_few_groups_promise_less() -> None:
    scores, groups = np.arange(6.0), np.array([0, 0, 1, 1, 2, 2])
    bound, reached = conformal_quantile(scores, groups, 0.9)
    assert reached == pytest.approx(3 / 4)
    assert bound == scores.max()


def test_groups_count_alike_whatever_their_size() -> None:
    scores = np.concatenate([np.full(1000, 1.0), [2.0, 3.0]])
    groups = np.concatenate([np.zeros(1000, int), [1, 2]])
    bound, _ = conformal_quantile(scores, groups, 0.5)
    assert bound == 2.0

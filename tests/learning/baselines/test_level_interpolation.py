"""Level interpolation knows what it may know, and nothing else."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.baselines.level_interpolation import LevelInterpolation
from physgnn.mechanics.loads.paths import LoadCase


def fitted(store: Store, train: np.ndarray) -> LevelInterpolation:
    surrogate = LevelInterpolation(store.body)
    surrogate.fit(store, train)
    return surrogate


@given(kept=st.sets(st.integers(0, 5), min_size=1), factor=st.floats(0.01, 1.0))
def test_interpolation_is_exact_where_displacement_is_linear_in_the_level(
    store: Store, kept: set[int], factor: float
) -> None:
    """Between levels, below the first and above the last."""
    train = np.array([[3, level] for level in sorted(kept)])
    full = store.load_path(3)
    case = LoadCase(full.nodes, factor * full.forces)
    answer = fitted(store, train).predict(case)
    expected = factor * store.displacement(3)[-1]
    np.testing.assert_allclose(answer, expected, atol=1e-5)


def test_interpolation_reads_no_level_it_was_not_given(store: Store) -> None:
    train = store.samples()
    train = train[train[:, 1] != 2]
    kept = fitted(store, train).arrays()
    assert store.load_factors[2] not in kept["factors"]
    assert len(kept["displacement"]) == len(train)


def test_interpolation_refuses_a_path_it_does_not_know(store: Store) -> None:
    train = store.samples()
    known = fitted(store, train[train[:, 0] != 1])
    with pytest.raises(InputError, match="own path"):
        known.predict(store.load_case(1, 0))

"""The classical learners there are: one row each."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from physgnn.dataset.store import Store
from physgnn.prediction.classical.estimator import (
    Estimator,
    ScaledNetwork,
    random_trees,
)
from physgnn.prediction.classical.load_features import IntArray
from physgnn.prediction.classical.nodal import nodal_answer
from physgnn.prediction.classical.pod import pod_answer
from physgnn.prediction.prediction import Answer


class Regressor(NamedTuple):
    """What a row stands for, and which estimator does it."""

    answer: Callable[..., Answer]
    estimator: Callable[[int], Estimator]


REGRESSORS: Mapping[str, Regressor] = {
    "pod_network": Regressor(
        pod_answer, lambda seed: ScaledNetwork((128, 128), epochs=200, seed=seed)
    ),
    "extra_trees": Regressor(
        nodal_answer, lambda seed: random_trees(20, smallest_leaf=5, seed=seed)
    ),
    "nodal_network": Regressor(
        nodal_answer, lambda seed: ScaledNetwork((128, 128), epochs=20, seed=seed)
    ),
}


def regressor_answer(name: str, store: Store, samples: IntArray, seed: int) -> Answer:
    """Return a row of `REGRESSORS`, fitted to samples.

    Parameters
    ----------
    name : str
        A row.
    store : Store
    samples : (n, 2) integer array
        Rows of (path, level) to learn from: the training part of a split.
    seed : int
        Of all that is drawn.
    """
    row = REGRESSORS[name]
    return row.answer(row.estimator(seed), store, samples, seed=seed)

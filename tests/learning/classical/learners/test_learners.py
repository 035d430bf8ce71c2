"""What the classical learners are wrapped in is exact where a learner is."""

import numpy as np
import pytest

from physgnn.dataset.storage.store import Store
from physgnn.learning.classical.learners import nodal_learner
from physgnn.learning.classical.learners.nodal_learner import NodalLearner
from physgnn.learning.classical.learners.pod_learner import PODLearner
from physgnn.learning.classical.learners.row_learner import RowLearner


class LeastSquares:
    """The best linear map, which the made-up body follows."""

    def fit(self, inputs: np.ndarray, targets: np.ndarray) -> None:
        self.inputs, self.targets = inputs, targets
        self.map = np.linalg.lstsq(inputs, targets, rcond=1e-5)[0]

    def predict(self, inputs: np.ndarray) -> np.ndarray:
        return inputs @ self.map

    def arrays(self) -> dict[str, np.ndarray]:
        return {"map": self.map}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        self.map = arrays["map"]


def split(store: Store) -> tuple[np.ndarray, np.ndarray]:
    samples = store.samples()
    return samples[samples[:, 0] < 7], samples[samples[:, 0] == 7]


def test_pod_of_an_exact_learner_is_exact_on_paths_never_seen(store: Store) -> None:
    """Seven load paths span the six-dimensional space of loads and answers."""
    train, test = split(store)
    learner = PODLearner(store.body, lambda _: LeastSquares())
    learner.fit(store, train)
    for path, level in test.tolist():
        found = learner.predict(store.load_case(path, level))
        np.testing.assert_allclose(found, store.displacement(path)[level], atol=1e-3)


def test_nodal_learner_is_told_what_belongs_together(store: Store) -> None:
    """Every row pairs a node's place with the displacement of that very node."""
    train, _ = split(store)
    learner = LeastSquares()
    NodalLearner(store.body, lambda _: learner).fit(store, train)
    places = store.mesh.points.astype(np.float32)
    found = np.array(
        [(places == row[:3]).all(axis=1).argmax() for row in learner.inputs]
    )
    per_sample = len(found) // len(train)
    for i, (path, level) in enumerate(train.tolist()):
        part = slice(i * per_sample, (i + 1) * per_sample)
        np.testing.assert_array_equal(
            learner.targets[part], store.displacement(path)[level][found[part]]
        )
        assert len(set(found[part].tolist())) == per_sample
    assert not np.isin(found, store.fixed).any()


def test_rows_are_bounded(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nodal_learner, "N_ROWS", 100)
    train, _ = split(store)
    learner = LeastSquares()
    NodalLearner(store.body, lambda _: learner).fit(store, train)
    assert len(train) <= len(learner.inputs) <= 100


@pytest.mark.parametrize("kind", [PODLearner, NodalLearner])
def test_fixed_points_stay(store: Store, kind: type[RowLearner]) -> None:
    train, _ = split(store)
    learner = kind(store.body, lambda _: LeastSquares())
    learner.fit(store, train)
    found = learner.predict(store.load_case(7, 3))
    np.testing.assert_allclose(found[store.fixed], 0, atol=1e-6)

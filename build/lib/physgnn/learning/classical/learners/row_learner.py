"""What surrogates have in common that learn rows of numbers by some estimator."""

from abc import abstractmethod
from collections.abc import Callable

from physgnn.arrays import IntArray
from physgnn.dataset.storage.store import Store
from physgnn.learning.classical.estimators.estimator import Estimator
from physgnn.learning.classical.learners.load_features import LoadFeatures
from physgnn.learning.surrogate import Arrays, Surrogate
from physgnn.mechanics.body import Body

LEARNER = "learner."


class RowLearner(Surrogate):
    """A surrogate whose load is a row of numbers, from which an estimator learns.

    Parameters
    ----------
    body : Body
        What is loaded.
    estimator : callable
        From a seed to an estimator that has learnt nothing yet.
    """

    draws = True
    features: LoadFeatures
    """Set by `fit` and `restore`."""

    def __init__(self, body: Body, estimator: Callable[[int], Estimator]) -> None:
        super().__init__(body)
        self._make, self.estimator = estimator, estimator(0)

    def fit(self, store: Store, samples: IntArray, seed: int = 0) -> None:
        """Find the loads' components, then learn."""
        self.features = LoadFeatures.of(store, samples)
        self.estimator = self._make(seed)
        self.learn(store, samples, seed)

    @abstractmethod
    def learn(self, store: Store, samples: IntArray, seed: int) -> None:
        """Make rows of samples and fit the estimator to them."""

    def arrays(self) -> Arrays:
        """Return the loads' components and what the estimator learnt."""
        learnt = self.estimator.arrays()
        return {
            "components": self.features.components,
            **{LEARNER + name: values for name, values in learnt.items()},
        }

    def restore(self, arrays: Arrays) -> None:
        """Take the loads' components and what the estimator learnt."""
        self.features = LoadFeatures(self.body.mesh.points, arrays["components"])
        self.estimator.restore(
            {
                name.removeprefix(LEARNER): values
                for name, values in arrays.items()
                if name.startswith(LEARNER)
            }
        )

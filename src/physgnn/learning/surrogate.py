"""The one interface of all methods: what gives the displacement under a load case.

A :class:`Surrogate` stands for one body: a network, a reduced model, a learner of rows,
the linear solution, the finite elements themselves. Training, run folders, predictions
with their error bounds, and comparisons use nothing but this:

>>> surrogate = build_model("reduced", body, anchors=64)   # nothing fitted yet
>>> surrogate.fit(store, split.train, seed=0)
>>> displacement = surrogate.predict(load_case)            # (n_points, 3), mm
>>> again = build_model("reduced", body, anchors=64)       # what a run folder does
>>> again.restore(surrogate.arrays())

To add a method, write one class in a file of its own (docs/templates/method.py is one
of thirty lines) and one row of :data:`physgnn.learning.models.MODELS`; or no row, and
name the class as ``module:Class`` wherever a method is named. It owes `predict`. One
that is fitted owes `fit`, `arrays` and `restore` as well. Everything else has a
default. Nothing here needs torch; a network that is trained step by step derives from
:class:`physgnn.learning.network.Network`.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import ELEMENTS
from physgnn.mechanics.equilibrium.reference_states import NearestReference
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadCase

if TYPE_CHECKING:
    from physgnn.dataset.storage.store import Store

Arrays = Mapping[str, NDArray[Any]]

TINY_N = 1e-6  # a load under which the rest state is the nearest reference state


class Surrogate(ABC):
    """What gives displacements under load cases on one body.

    A subclass takes the body and then its own options by keyword, each with a default,
    such as JSON can hold: a run folder records them and builds the surrogate anew.

    Parameters
    ----------
    body : Body
        What is loaded.
    """

    elements: ClassVar[tuple[str, ...]] = ELEMENTS
    """The elements of bodies that it knows."""
    learns: ClassVar[bool] = True
    """Whether `fit` learns: then it needs samples, and its time counts."""
    draws: ClassVar[bool] = False
    """Whether `fit` depends on the seed."""
    zero_without_load: ClassVar[bool] = False
    """Whether the displacement vanishes, exactly, with the load."""

    def __init__(self, body: Body) -> None:
        self.body = body

    @abstractmethod
    def predict(self, load_case: LoadCase) -> FloatArray:
        """Return the displacement under a load, (n_points, 3) float64, mm."""

    def fit(self, store: "Store", samples: IntArray, seed: int = 0) -> None:
        """Learn from samples of a store.

        Parameters
        ----------
        store : Store
            The dataset, on this body. It is read path by path: all displacements
            together may not fit into memory.
        samples : (n, 2) integer array
            Rows of path and level: the training part of a split.
        seed : int
            Of everything that is drawn.
        """
        del store, samples, seed  # nothing is learnt

    def arrays(self) -> Arrays:
        """Return what `fit` found, by name: all that `restore` needs."""
        return {}

    def restore(self, arrays: Arrays) -> None:
        """Take what `arrays` returned, in a surrogate of the same body and options.

        Displacements are the same afterwards, bit for bit.
        """
        del arrays  # there are none

    # What a method may know better than the default does.

    def sample_case(self, store: "Store", path: int, level: int) -> LoadCase:
        """Return what it is told of a sample of a dataset: by default the load alone.

        A method that takes a measured displacement is told more
        (`physgnn.mechanics.loads.observed`); a comparison says so.
        """
        return store.load_case(path, level)

    def linear(self, load_case: LoadCase) -> FloatArray:
        """Return the linear solution K₀⁻¹ f, (n_points, 3), mm."""
        return self._rest.solve(load_case.on_points(self.body.mesh.n_points))

    @cached_property
    def _rest(self) -> RestState:
        return RestState(self.body)

    def is_sound(self, load_case: LoadCase) -> bool:  # noqa: ARG002
        """Return whether a displacement just predicted is to be trusted at all."""
        return True

    def reference_states(self) -> NearestReference | None:
        """Return how to find the nearest stable equilibrium it carries with it.

        Estimates of the error and repairs start from there. None: from rest only.
        """
        return None

    def warm_up_cases(self) -> Iterator[LoadCase]:
        """Yield loads whose first prediction factorises, compiles and allocates."""
        body = self.body
        free = np.setdiff1d(np.arange(body.mesh.n_points), body.fixed)
        yield LoadCase(free[:1], np.full((1, 3), TINY_N))

    def prepare(self, *, device: str = "cpu", precision: str = "float32") -> None:  # noqa: ARG002
        """Get ready to predict on a device, as torch names it, in a precision.

        Raises
        ------
        InputError
            If there is nothing that the precision would change.
        """
        if precision != "float32":
            raise InputError(
                f"precision {precision} is for the LSTMs of PhysGNN, and this model "
                "has none: leave precision at float32"
            )

    def transfer(self, trained: Self, forces: FloatArray) -> None:  # noqa: ARG002
        """Take over what another body's surrogate learnt; nothing is trained.

        Parameters
        ----------
        trained : Surrogate
            Of the same class and options.
        forces : (n_loads, n_points, 3) array
            Loads like those to come on this body, each at its strongest, N.

        Raises
        ------
        InputError
            If what it learnt belongs to its body.
        """
        raise InputError(
            f"{type(self).__name__} belongs to its mesh: train model lifted with "
            "pod_modes = 0"
        )

    @property
    def n_weights(self) -> int:
        """How many numbers were trained step by step."""
        return 0

    # Which comparisons it belongs in.

    @classmethod
    def applies_to(cls, store: "Store", train: IntArray, test: IntArray) -> bool:  # noqa: ARG003
        """Return whether it can be fitted to `train` and predict `test`."""
        return len(train) > 0 or not cls.learns

    @classmethod
    def is_meant_for(cls, store: "Store", test: IntArray) -> bool:  # noqa: ARG003
        """Return whether it belongs in every comparison on such loads.

        Otherwise it must be asked for by name.
        """
        return True


class FromFunction(Surrogate):
    """A function as a surrogate; it is not saved.

    Parameters
    ----------
    body : Body
        What is loaded.
    displacement : callable
        From a load case to the displacement (n_points, 3), mm.
    """

    learns = False

    def __init__(
        self, body: Body, displacement: Callable[[LoadCase], FloatArray]
    ) -> None:
        super().__init__(body)
        self._displacement = displacement

    def predict(self, load_case: LoadCase) -> FloatArray:
        """Return what the function returns."""
        return self._displacement(load_case)

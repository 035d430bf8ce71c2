"""What every network offers to training, checkpoints and prediction.

A :class:`Model` is everything between a load case and its displacement: the network,
the statistics it was fitted with (all in ``state_dict``, so that one safetensors file
holds them) and what it needs to know of the body it was made for. Training, reloading
and predicting use nothing but this:

>>> model = MODELS["physgnn"](body, configuration=3, dataset=2)     # untrained
>>> model.fit(store, split.train)                                   # statistics only
>>> x = torch.stack([model.encode(case) for case in cases])         # (batch, n, inputs)
>>> y = model(x, graph_of(body))                                    # (batch, n, 3), mm

To add a network: subclass :class:`Model`, take as options what JSON can hold, and add
one row to :data:`physgnn.learning.models.MODELS`.

* ``__init__(body, *, …)`` takes its options by keyword, each with a default, and makes
  a model of which every buffer already has its final shape, because a checkpoint is
  read by building the model with the recorded options and loading its state; ``fit``
  isn't called then. What follows from the body alone (a factorisation, columns of its
  inverse) is made here, outside ``state_dict`` unless it's cheaper to store than to
  make again.
* ``fit(store, samples)`` fills the buffers from these samples (the training set) and
  reads the store lazily: it never holds all displacements.
* ``encode(load_case)`` is called for one load case at a time, in float64 up to its
  last line, and returns float32 inputs; all that ``forward`` needs of the load must be
  in them (a lifted network puts the linear solution into three of its columns).
  Work that depends on the load but not on trained weights belongs here.
* ``forward(inputs, graph)`` takes a batch of inputs on any device, with the graph on
  the same one, and returns displacement in mm (not a correction to it).
"""

import copy
from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from torch import Tensor, nn

from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.learning.graph import Graph
from physgnn.mechanics.body import Body
from physgnn.mechanics.element import DEFAULT_ELEMENT
from physgnn.mechanics.loads import LoadCase

IntArray = NDArray[np.int64]


class Model(nn.Module, ABC):
    """A network bound to a body; see the module's text for what each method owes."""

    body: Body
    elements: ClassVar[tuple[str, ...]] = (DEFAULT_ELEMENT,)
    """Those that it computes with."""

    @abstractmethod
    def fit(self, store: Store, samples: IntArray) -> None:
        """Fit the statistics to samples, (n, 2) rows of path and level."""

    @abstractmethod
    def encode(self, load_case: LoadCase) -> Tensor:
        """Return the network's inputs for a load case, (n_points, n_inputs) float32."""

    def share_weights(self, other: "Model") -> None:  # noqa: ARG002
        """Take another body's model's weights for one's own, in training too.

        Raises
        ------
        InputError
            If what the model learns belongs to one body.
        """
        raise InputError(
            f"{type(self).__name__} learns from one body: give one dataset, or train "
            "model lifted with modes = 0"
        )

    def own_weights(self) -> None:
        """Copy shared weights, to train them without changing the other model's."""
        for name, part in self.named_children():
            setattr(self, name, copy.deepcopy(part).train())

    def refine(
        self,
        load_case: LoadCase,  # noqa: ARG002
        displacement: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Improve on the network's answer (n_points, 3), mm, if there's a way to."""
        return displacement

    def release(self) -> None:
        """Free what encoding keeps in memory; it's made again when needed."""

    def spare_memory(self, spare: bool) -> None:
        """Train with less memory, if more slowly; not if there's no way to."""

    @abstractmethod
    def forward(self, inputs: Tensor, graph: Graph) -> Tensor:
        """Return displacement in mm, (batch, n_points, 3), for encoded inputs."""

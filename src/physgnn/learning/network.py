"""What a surrogate trained step by step by gradient offers besides.

A :class:`Network` splits a prediction in two: `encode` does, once a load, all that
depends on no trained weight; `forward` turns encoded inputs into displacements, batch
by batch, and is what training differentiates. Weights and statistics are all in
``state_dict``, and that is what a run folder keeps. From these this class makes what
every surrogate owes.

* ``__init__`` makes a network of which every buffer already has its final shape,
  because a run folder is read by building the network with the recorded options and
  loading its state; ``fit`` is not called then. What follows from the body alone (a
  factorisation, columns of its inverse) is made here, outside ``state_dict`` unless it
  is cheaper to store than to make again.
* ``fit`` fills the buffers from the training samples; training follows.
* ``encode`` works in float64 up to its last line and returns float32 inputs; all that
  ``forward`` needs of the load must be in them.
* ``forward`` takes a batch of inputs on any device, with the graph on the same one, and
  returns displacement in mm (not a correction to it).
"""

import copy
from abc import abstractmethod
from typing import ClassVar, Self

import numpy as np
import torch
from torch import Tensor, nn

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.learning.graph import Graph, graph_of
from physgnn.learning.surrogate import Arrays, Surrogate
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase


class Network(nn.Module, Surrogate):
    """A network bound to a body; see the module's text for what each method owes.

    Parameters
    ----------
    body : Body
        What it is made for.

    Attributes
    ----------
    useful_untrained : bool
        Whether it is a method of its own before it has learnt. Its weights of then are
        kept if training finds none with a lower validation loss.
    """

    draws = True
    useful_untrained: ClassVar[bool] = False

    def __init__(self, body: Body) -> None:
        super().__init__()
        self.body = body
        self._graph: Graph | None = None

    @abstractmethod
    def encode(self, load_case: LoadCase) -> Tensor:
        """Return the network's inputs for a load case, (n_points, n_inputs) float32."""

    @abstractmethod
    def forward(self, inputs: Tensor, graph: Graph) -> Tensor:
        """Return displacement in mm, (batch, n_points, 3), for encoded inputs."""

    def at_points(self, inputs: Tensor, graph: Graph, points: Tensor) -> Tensor:
        """Return what `forward` does at some points, (batch, n, 3), mm.

        A network that can leave out work on the others does so.
        """
        displacement: Tensor = self(inputs, graph)[:, points]
        return displacement

    def refine(
        self,
        load_case: LoadCase,  # noqa: ARG002
        displacement: FloatArray,
    ) -> FloatArray:
        """Improve on what `forward` returned (n_points, 3), mm, if there is a way."""
        return displacement

    def share_weights(self, other: Surrogate) -> None:  # noqa: ARG002
        """Take another body's network's weights for one's own, in training too.

        Raises
        ------
        InputError
            If what the network learns belongs to one body.
        """
        raise InputError(
            f"{type(self).__name__} learns from one body: give one dataset, or train "
            "model lifted with pod_modes = 0"
        )

    def transfer(self, trained: Self, forces: FloatArray) -> None:
        """Take the weights, if they serve any body: then all that was learnt is there.

        Raises
        ------
        InputError
            If what the network learns belongs to one body.
        """
        if type(self).share_weights is Network.share_weights:
            super().transfer(trained, forces)
        self.share_weights(trained)

    def own_weights(self) -> None:
        """Copy shared weights, to train them without changing the other network's."""
        for name, part in self.named_children():
            setattr(self, name, copy.deepcopy(part).train())

    def begin_with(self, other: Surrogate) -> None:
        """Begin a training with a copy of another body's network's weights.

        Raises
        ------
        InputError
            If the other's weights do not fit this network.
        """
        self.share_weights(other)
        self.own_weights()

    def release(self) -> None:
        """Free what encoding keeps in memory; it is made again when needed."""

    def spare_memory(self, spare: bool) -> None:
        """Train with less memory, if more slowly; not if there is no way to."""

    def set_precision(self, precision: str) -> None:
        """Choose the precision of the largest products, in training as well.

        Raises
        ------
        InputError
            If the network has no other than float32.
        """
        if precision != "float32":
            raise InputError(
                f"{precision} is for the LSTMs of PhysGNN, and this model has none: "
                "leave precision at float32"
            )

    # What every surrogate owes, made of these.

    @torch.inference_mode()
    def predict(self, load_case: LoadCase) -> FloatArray:
        """Return the displacement under a load, (n_points, 3), mm."""
        if self.training:
            self.eval()
        graph = self._graph_there()
        inputs = self.encode(load_case).to(graph.column.device).unsqueeze(0)
        displacement: FloatArray = self(inputs, graph)[0].cpu().numpy()
        return self.refine(load_case, displacement.astype(np.float64))

    def _graph_there(self) -> Graph:
        """Return the graph, on the device of the weights."""
        device = next(self.parameters()).device
        if self._graph is None or self._graph.column.device != device:
            self._graph = graph_of(self.body).to(device)
        return self._graph

    def arrays(self) -> Arrays:
        """Return the state, by the names torch gives it."""
        return {k: v.detach().cpu().numpy() for k, v in self.state_dict().items()}

    def restore(self, arrays: Arrays) -> None:
        """Load the state, and be ready to predict."""
        self.load_state_dict({name: torch.tensor(v) for name, v in arrays.items()})
        self.eval()

    def prepare(self, *, device: str = "cpu", precision: str = "float32") -> None:
        """Move to a device and choose the precision; see `set_precision`."""
        self.set_precision(precision)
        self.to(device).eval()

    @property
    def n_weights(self) -> int:
        """How many weights there are."""
        return sum(weight.numel() for weight in self.parameters())

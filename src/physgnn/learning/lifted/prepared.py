"""What a lifted network makes of its body and its buffers, each when first needed."""

from collections.abc import Mapping
from functools import cached_property

import numpy as np
import torch
from torch import Tensor

from physgnn.arrays import BoolArray, FloatArray
from physgnn.learning.lifted.carried_forces import CarriedForces
from physgnn.learning.lifted.network import NetworkRegion
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.reduced.expansions.asymptotic import AsymptoticExpansion
from physgnn.mechanics.reduced.submodels.force_left import ForceLeft
from physgnn.mechanics.reduced.submodels.patch_relaxation import PatchRelaxation


class Prepared:
    """What follows from the buffers of a lifted network: dropped when these change.

    Parameters
    ----------
    body, turned : Body
        What is loaded, and the same along its own axes.
    buffers : mapping of str to Tensor
        Those of the network, by name.
    exponential, relaxed_patches
        See `physgnn.learning.lifted.model.LiftedModel`.
    """

    def __init__(
        self,
        body: Body,
        turned: Body,
        buffers: Mapping[str, Tensor],
        *,
        exponential: bool,
        relaxed_patches: int,
    ) -> None:
        self._body, self._turned, self._buffers = body, turned, buffers
        self._exponential, self._relaxed_patches = exponential, relaxed_patches
        self._regions: dict[torch.device, NetworkRegion] = {}
        self._carried: dict[torch.device, CarriedForces] = {}

    @property
    def near(self) -> BoolArray:
        """The points near loads, (n_points,)."""
        return np.asarray(self._buffers["near"].cpu().numpy(), dtype=np.bool_)

    @cached_property
    def expansion(self) -> AsymptoticExpansion:
        """The expansion, along the body's axes."""
        return AsymptoticExpansion(
            self._turned,
            self._buffers["anchor_states"].cpu().numpy(),
            strained=self.near if self._exponential else None,
            threads=torch.get_num_threads(),
        )

    @cached_property
    def force_left(self) -> ForceLeft:
        """What finds the force that an expansion leaves, along the body's axes."""
        return ForceLeft(self._turned, self.near)

    def relaxed(self, load_case: LoadCase, displacement: FloatArray) -> FloatArray:
        """Relax the worst patches of a prediction, along the world's axes, mm."""
        if self._relaxed_patches == 0 or self._body.element != DEFAULT_ELEMENT:
            return displacement
        return self._relaxation(load_case.on_points(len(displacement)), displacement)

    @cached_property
    def _relaxation(self) -> PatchRelaxation:
        return PatchRelaxation(self._body, self.near, self._relaxed_patches)

    def region_on(self, device: torch.device) -> NetworkRegion:
        """Return the part of the mesh that the network works on, on a device."""
        if device not in self._regions:
            with torch.inference_mode(False):  # a prediction's must serve training, too
                region = NetworkRegion.of(self._turned, self.near)
                self._regions[device] = region.to(device)
        return self._regions[device]

    def carried_on(self, device: torch.device) -> CarriedForces:
        """Return what carries the network's forces through the body, on a device."""
        if device not in self._carried:
            points = self.region_on(device).points
            with torch.inference_mode(False):  # a copy on a device must serve it, too
                responses, loaded = (
                    self._buffers[name].to(device) for name in ("responses", "loaded")
                )
                self._carried[device] = CarriedForces.of(responses, loaded, points)
        return self._carried[device]

    def release(self) -> None:
        """Free the factors."""
        self.__dict__.pop("expansion", None)

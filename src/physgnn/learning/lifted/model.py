"""The lifted network: physics carries the displacement, a network what is left over.

u = ū + u₁ + u₂ + u₃ (`physgnn.mechanics.reduced.expansions.asymptotic`) + ‖u₂‖ · (g +
Φ Φᵀ f + modes): the network gives a displacement g near the loads, and forces f on the
loaded points that move the whole body by its response modes Φ. The factor, the mean
length of u₂, makes the correction O(load²) or smaller, so that small loads get the
linear solution, and none nothing. All is along the body's own axes, and turns with it.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Self

import numpy as np
import torch
from torch import Tensor, nn

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_points
from physgnn.geometry.mesh_topology import points_within
from physgnn.learning.graph import Graph, as_float32
from physgnn.learning.lifted.any_axes import answered
from physgnn.learning.lifted.network import LiftedNetwork
from physgnn.learning.lifted.own_axes import body_axes, turned
from physgnn.learning.lifted.pod_modes import fitted_modes, products, size
from physgnn.learning.lifted.prepared import Prepared
from physgnn.learning.network import Network
from physgnn.learning.shared_weights import part_of_another
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.reference_states import (
    NearestReference,
    ReferenceState,
)
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.reduced.expansions.anchors import (
    expected_anchors,
    loads_held_by,
)
from physgnn.mechanics.reduced.expansions.asymptotic import AsymptoticExpansion
from physgnn.mechanics.reduced.expansions.response_modes import softest_responses
from physgnn.mechanics.reduced.submodels.near_loads import NearLoads

if TYPE_CHECKING:
    from physgnn.dataset.storage.store import Store

HIDDEN = 64  # of the small network from modes to modes


class LiftedModel(Network):
    """The expansion about the nearest anchor, corrected.

    Parameters
    ----------
    body : Body
        What it's made for.
    anchors : int
        Equilibria to expand about, besides the rest state.
    k_hops : int
        The local network works on the k-hop neighbourhood of the loaded points: those
        at most so many edges from one of them.
    width, layers : int
        Of the local network.
    response_modes : int
        Shapes by which the body answers forces on the loaded points and the surface
        near them: they carry the network's forces beyond the neighbourhood. They are
        found without a solution: nothing learnt belongs to this body. 0 for none.
    pod_modes : int
        Further shapes of the correction, added by a small network: POD modes of solved
        samples. With any, what is learnt belongs to this body alone.
    submodel_hops : int
        Under a force on few points, the submodel of the cells at most so many edges
        from it is solved (`near_loads`); 0: none is.
    relaxed_patches : int
        So many patches, those most out of balance, are relaxed (`patch_relaxation`).
    any_axes : bool
        While it learns, the network sees the body along axes drawn at random. That
        serves loads at places, and on bodies, that training has not; for the very
        points that it has, it learns less.
    exponential, imbalance : bool
        Whether the expansion has its term of finite rotation and strain, and whether
        the network sees what force it leaves out of balance.
    """

    zero_without_load = True
    useful_untrained = True  # the expansion
    axes: Tensor
    free: Tensor
    anchor_states: Tensor
    near: Tensor
    responses: Tensor
    loaded: Tensor
    modes: Tensor
    mode_scale: Tensor

    def __init__(
        self,
        body: Body,
        *,
        anchors: int = 6,
        k_hops: int = 3,
        width: int = 32,
        layers: int = 4,
        response_modes: int = 64,
        pod_modes: int = 0,
        submodel_hops: int = 5,
        relaxed_patches: int = 8,
        any_axes: bool = False,
        exponential: bool = True,
        imbalance: bool = True,
    ) -> None:
        super().__init__(body)
        counts = {
            "anchors": anchors,
            "k_hops": k_hops,
            "response_modes": response_modes,
            "pod_modes": pod_modes,
            "submodel_hops": submodel_hops,
            "relaxed_patches": relaxed_patches,
        }
        if min(counts.values()) < 0 or min(width, layers) < 1:
            raise InputError(
                f"{', '.join(counts)} must be ≥ 0 (got {tuple(counts.values())}), "
                f"width and layers ≥ 1 (got {width}, {layers})"
            )
        self.k_hops, self.any_axes = k_hops, any_axes
        self.exponential, self.imbalance = exponential, imbalance
        free = np.ones((n := body.mesh.n_points, 1))
        free[body.fixed] = 0.0
        # In float64 for the mechanics; the buffer beside it is the network's.
        self._axes64 = axes = body_axes(body.mesh)
        self.relaxed_patches = relaxed_patches
        self._near_loads = NearLoads(body, submodel_hops)
        self._turned = turned(body, axes)
        self.register_buffer("axes", as_float32(axes), persistent=False)
        self.register_buffer("free", as_float32(free), persistent=False)
        self.register_buffer("anchor_states", torch.zeros(anchors, n, 3))
        self.register_buffer("near", torch.ones(n, dtype=torch.bool))
        self._has_responses = response_modes > 0
        if response_modes:  # runs of before there were any hold none
            self.register_buffer("responses", torch.zeros(response_modes, n, 3))
            self.register_buffer("loaded", torch.zeros(n, dtype=torch.bool))
        self.register_buffer("modes", torch.zeros(pod_modes, n, 3))
        self.register_buffer("mode_scale", torch.ones(3 * pod_modes))
        self.local = LiftedNetwork(
            width, layers, forces=response_modes > 0, imbalance=imbalance
        )
        self.coefficients = nn.Sequential(
            nn.Linear(3 * pod_modes, HIDDEN), nn.SiLU(), nn.Linear(HIDDEN, pod_modes)
        ) if pod_modes else None  # fmt: skip
        self._forget()
        self.register_load_state_dict_post_hook(_forget)  # type: ignore[no-untyped-call]

    def _forget(self) -> None:
        """Drop what was made from the buffers; it's made again when needed."""
        self._prepared = Prepared(
            self.body,
            self._turned,
            dict(self.named_buffers(recurse=False)),
            exponential=self.exponential,
            relaxed_patches=self.relaxed_patches,
        )

    @property
    def expansion(self) -> AsymptoticExpansion:
        """The expansion, in the body's axes."""
        return self._prepared.expansion

    def fit(self, store: "Store", samples: IntArray, seed: int = 0) -> None:
        """Find the anchors, the points near loads, and the modes."""
        from physgnn.dataset.training_loads import strongest_forces

        del seed
        self.expect(strongest_forces(store, samples))
        if len(self.modes):
            n = len(self.modes)
            modes, scale = fitted_modes(self.encode, self.axes, store, samples, n)
            self.modes.copy_(modes), self.mode_scale.copy_(scale)

    def expect(self, forces: FloatArray) -> None:
        """Find the anchors and the points near loads, from loads without solutions.

        Parameters
        ----------
        forces : (n_loads, n_points, 3) array
            Loads like those to come, each at its strongest, N.
        """
        loaded = np.flatnonzero(forces.any(axis=(0, 2)))
        near = points_within(self.body.mesh, loaded, self.k_hops)
        self.near.copy_(torch.from_numpy(near))
        n_anchors = len(self.anchor_states)
        states = expected_anchors(self._turned, forces @ self._axes64.T, n_anchors)
        self.anchor_states.copy_(torch.from_numpy(states))
        self._forget()
        surface = boundary_points(self.body.mesh)  # a load may come beside those known
        self._find_responses(np.union1d(loaded, surface[near[surface]]))

    def _find_responses(self, pushed: IntArray) -> None:
        """Find how the body at rest answers forces on some points."""
        if not self._has_responses:
            return
        n, free = self.body.mesh.n_points, np.setdiff1d(pushed, self.body.fixed)
        at_rest = self.expansion.about(np.zeros((n, 3)))
        found = softest_responses(at_rest.solve, free, n, len(self.responses))
        self.responses.copy_(torch.from_numpy(found))
        self.loaded.zero_()[torch.from_numpy(free)] = True

    def share_weights(self, other: Surrogate) -> None:
        """Take another body's network's weights for one's own, in training too."""
        if not isinstance(other, LiftedModel) or len(self.modes) or len(other.modes):
            raise InputError(
                "only the local part of a lifted network may serve several bodies: "
                "train model lifted with pod_modes = 0"
            )
        sizes = "width, layers, response_modes and imbalance"
        self.local = part_of_another(self.local, other.local, sizes)

    def transfer(self, trained: Self, forces: FloatArray) -> None:
        """Take the weights; find anchors of one's own, under loads to be expected."""
        self.share_weights(trained)
        self.expect(forces)

    def release(self) -> None:
        """Free the factors."""
        self._prepared.release()

    def reference_states(self) -> NearestReference:
        """Return how to find the nearest anchor, and its response to a little more."""
        axes = self._axes64

        def nearest(force: FloatArray) -> ReferenceState:
            about = self.expansion.about(force @ axes.T)
            return ReferenceState(
                about.u @ axes, lambda f: about.solve(f @ axes.T) @ axes
            )

        return nearest

    def warm_up_cases(self) -> Iterator[LoadCase]:
        """Yield a tiny load, those that anchors balance, and one that none does."""
        yield from super().warm_up_cases()
        states = self.anchor_states.cpu().numpy().astype(np.float64)
        held = list(loads_held_by(self.body, states @ self._axes64))
        yield from held
        yield from (replace(case, forces=0.8 * case.forces) for case in held[-1:])

    def encode(self, load_case: LoadCase) -> Tensor:
        """Return the expansion's displacement, u₁, u₂ and forces in the body's axes.

        Returns
        -------
        (n_points, 12 or 15) float32 tensor
            mm; load and, if the network sees it, imbalance, N.
        """
        force = self._force(load_case)
        terms = self.expansion.expand(force)
        columns = [terms.displacement, terms.first, terms.second, force]
        if self.imbalance:
            left = self._prepared.force_left(force, terms.displacement)
            columns.append(left)
        return as_float32(np.column_stack(columns))

    def linear(self, load_case: LoadCase) -> FloatArray:
        """Return K₀⁻¹ f, (n_points, 3) mm, in the world's axes, by kept columns."""
        return self.expansion.linear(self._force(load_case)) @ self._axes64

    def _force(self, load_case: LoadCase) -> FloatArray:
        return load_case.on_points(self.body.mesh.n_points) @ self._axes64.T

    def forward(self, inputs: Tensor, graph: Graph) -> Tensor:  # noqa: ARG002
        """Return displacement in mm, (batch, n_points, 3), in the world's axes."""
        expanded, first, second, forces = inputs.tensor_split((3, 6, 9), dim=-1)
        scale = size(second)
        patch = self._prepared.region_on(inputs.device)
        terms = torch.cat([expanded - first - second, first, second], dim=-1)
        given = terms[:, patch.points], forces[:, patch.points], scale, patch
        near, pushed = answered(self.local, given, any_axes=self.any_axes)
        correction = torch.zeros_like(expanded).index_copy(1, patch.points, near)
        if self._has_responses:
            correction = correction + self._prepared.carried_on(inputs.device)(pushed)
        if self.coefficients is not None:
            fields = torch.stack([first, second, correction], dim=1)
            projected = products(fields, self.modes) / self.mode_scale
            shares = self.coefficients(projected)
            correction = correction + torch.tensordot(shares, self.modes, dims=1)
        displacement: Tensor = (expanded + self.free * scale * correction) @ self.axes
        return displacement

    def refine(self, load_case: LoadCase, displacement: FloatArray) -> FloatArray:
        """Bring cells near the load into equilibrium, or nearer to it."""
        refined = self._near_loads.corrected(load_case, displacement)
        return self._prepared.relaxed(load_case, refined)


def _forget(model: nn.Module, _: object) -> None:
    assert isinstance(model, LiftedModel)
    model._forget()

"""The reduced model where anchors are known, the network where they are not.

A load on points that training loaded is answered by the reduced model alone
(`physgnn.learning.reduced`). A load on other points is answered by the local expansion
about the rest state, û, exact in the cells around those points; what it misses comes
from the cells beside these and is much alike wherever the load acts, so the correction
of the lifted network is learnt for it, with u₁ = K₀⁻¹f and û − u₁ in place of an
expansion's two terms. In training every load is taken for one on other points.
"""

import numpy as np
import torch
from torch import Tensor

from physgnn.dataset.definition import DEFAULT_ELEMENT
from physgnn.dataset.store import Store
from physgnn.learning.graph import as_float32
from physgnn.learning.interface import Body, Model
from physgnn.learning.lifted import FloatArray, IntArray, LiftedModel
from physgnn.learning.mesh_gradient import points_within
from physgnn.learning.reduced import ReducedModel
from physgnn.mechanics.loads import LoadCase

LOADED = "loaded"  # point set of a mesh; loads may come there that training hasn't


class CombinedModel(LiftedModel):
    """Local expansions, corrected by a network where no anchor is known.

    Parameters
    ----------
    body : Body
        What it's made for; its elements are tet4.
    anchors, together, reach_from_rest : int
        As of the reduced model.
    reach, width, layers, modes : int
        As of the lifted network.
    """

    elements = (DEFAULT_ELEMENT,)

    def __init__(
        self,
        body: Body,
        *,
        anchors: int = 128,
        together: int = 3,
        reach_from_rest: int = 2,
        reach: int = 4,
        width: int = 32,
        layers: int = 4,
        modes: int = 16,
    ) -> None:
        super().__init__(
            body, anchors=0, reach=reach, width=width, layers=layers, modes=modes
        )
        self.reduced = ReducedModel(
            body, anchors=anchors, together=together, reach_from_rest=reach_from_rest
        )
        self._deployed = False

    def fit(self, store: Store, samples: IntArray) -> None:
        """Choose the anchors, and find the points near loads and the modes."""
        self.reduced.fit(store, samples)
        super().fit(store, samples)

    def expect(self, forces: FloatArray) -> None:
        """Find the points near loads: those given, and what the mesh lays open."""
        mesh = self.body.mesh
        loaded = np.flatnonzero(forces.any(axis=(0, 2)))
        if LOADED in mesh.point_sets:
            loaded = np.union1d(loaded, mesh.point_set(LOADED))
        near = points_within(mesh, loaded, self.reach)
        self.near.copy_(torch.from_numpy(near))
        self._forget()

    def deploy(self) -> None:
        """Use the anchors from now on."""
        self._deployed = True

    def share_weights(self, other: Model) -> None:
        """Refuse: anchors belong to one body."""
        Model.share_weights(self, other)

    def encode(self, load_case: LoadCase) -> Tensor:
        """Return the local expansion's answer, its two terms and the force.

        Returns
        -------
        (n_points, 12) float32 tensor
            mm and N, in the body's axes. The second term is zero where the answer is
            that of anchors, which no network corrects.
        """
        force = self._force(load_case)
        if self._deployed and self.reduced.is_known(load_case):
            answer = self.reduced.encode(load_case).numpy() @ self._axes64.T
            first, second = answer, np.zeros_like(answer)
        else:
            answer = self.reduced.from_rest(load_case).displacement @ self._axes64.T
            first = self.perturbation.linear(force)
            second = answer - first
        return as_float32(np.column_stack([answer, first, second, force]))

    def refine(self, load_case: LoadCase, displacement: FloatArray) -> FloatArray:
        """Bring the cells near a load into equilibrium, unless anchors answered it."""
        if self._deployed and self.reduced.is_known(load_case):
            return displacement
        return super().refine(load_case, displacement)

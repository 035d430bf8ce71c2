"""A meshless body under the loads of one path: what is out of balance, and its rest.

Forces on points act through the shape functions, f_j = Σ_i φ_j(X_i) f_i, so that the
work they do is that on the approximated displacement.
"""

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import Elements
from physgnn.mechanics.loads.external_force import Loading
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.meshless.approximation import Approximation
from physgnn.mechanics.meshless.dynamic_relaxation import (
    DynamicRelaxation,
    Imbalance,
    SettledState,
)
from physgnn.mechanics.meshless.essential_conditions import EssentialConditions
from physgnn.mechanics.meshless.integrated_forces import internal_force
from physgnn.mechanics.meshless.options import MeshlessOptions
from physgnn.mechanics.support import check_held

POWER_STEPS = 20
# The power method comes from below; what it misses is learnt on the way.
POWER_MARGIN = 1.1
SMALL_MM = 1e-6  # at rest the force is linear in so small a displacement
SEED = 0


class LoadedBody:
    """Forces and rest of a body under a path.

    Parameters
    ----------
    body : Body
    path : LoadPath
    elements : Elements
        Law, constants and volume of every cell.
    approximation : Approximation
    mass : (n_points,) array
        Scaled masses without springs, N/mm.
    options : MeshlessOptions

    Raises
    ------
    InputError
        If the load does not fit the body, or leaves a part of it free to move.
    """

    def __init__(
        self,
        body: Body,
        path: LoadPath,
        *,
        elements: Elements,
        approximation: Approximation,
        mass: FloatArray,
        options: MeshlessOptions,
    ) -> None:
        self._loading = Loading(body.mesh, path, body.fixed)
        held = np.union1d(body.fixed, self._loading.held)
        check_held(body.mesh, held)
        self._held, self._elements = held, elements
        self._at, self._shape = approximation.integration, approximation.shape
        self._spread = self._shape.T.tocsr()
        size = abs(self._shape)
        springs = size.T @ (self._loading.stiffness * (size @ np.ones(len(mass))))
        self._mass = mass + springs
        self._conditions = EssentialConditions(self._shape, held, self._mass)
        greatest = POWER_MARGIN * self._greatest_eigenvalue()
        self._dynamics = DynamicRelaxation(self._mass, greatest, options)

    @property
    def n_steps(self) -> int:
        """Time steps taken so far."""
        return self._dynamics.n_steps

    def undeformed(self) -> FloatArray:
        """Return the nodal parameters where nothing has moved."""
        return np.zeros((len(self._mass), 3))

    def come_to_rest(self, start: FloatArray, load_factor: float) -> SettledState:
        """Put held points where they belong and let all others move until they rest."""
        place = np.zeros_like(start)
        self._loading.place(place, load_factor)
        start = self._conditions.impose(start, place[self._held])

        def balance(u: FloatArray) -> Imbalance:
            return self._imbalance(u, load_factor)

        return self._dynamics.come_to_rest(balance, start)

    def _imbalance(self, u: FloatArray, load_factor: float) -> Imbalance:
        elements = self._loading.elements(self._elements, load_factor)
        internal, inverted = internal_force(self._at, elements, u)
        external = self._spread @ self._loading.force(self._shape @ u, load_factor)
        force = external - internal
        reaction = self._conditions.reaction(force)
        scale = max(float(np.linalg.norm(f)) for f in (external, reaction))
        return Imbalance(force - reaction, scale, inverted)

    def _greatest_eigenvalue(self) -> float:
        """Return A_m of M⁻¹K at rest by the power method, among what can move."""
        mass, found = self._mass[:, None], 0.0
        motion = np.random.default_rng(SEED).standard_normal((len(mass), 3))
        for _ in range(POWER_STEPS):
            motion = self._conditions.impose(motion, np.zeros((len(self._held), 3)))
            motion *= SMALL_MM / np.abs(motion).max()
            force, _ = internal_force(self._at, self._elements, motion)
            force += self._spread @ (
                self._loading.stiffness[:, None] * (self._shape @ motion)
            )
            found = float((motion * force).sum() / (mass * motion**2).sum())
            motion = force / mass
        return found

"""A second solver of load paths: meshless, total Lagrangian, explicit (MTLED).

Displacement comes from modified moving least squares of the mesh's points, forces are
integrated over its cells, and every level is reached by dynamic relaxation.

Source: Joldes et al. 2019, "Suite of meshless algorithms for accurate computation of
soft tissue deformation for surgical simulation", Medical Image Analysis 56, 152–171.
"""

import numpy as np

from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import make_elements
from physgnn.mechanics.equilibrium.predictor_step import PathHistory
from physgnn.mechanics.equilibrium.solution import LevelRecord, Solution, Status
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.meshless.approximation import make_approximation
from physgnn.mechanics.meshless.dynamic_relaxation import SettledState
from physgnn.mechanics.meshless.integrated_forces import scaled_mass
from physgnn.mechanics.meshless.loaded_body import LoadedBody
from physgnn.mechanics.meshless.options import DEFAULT_MESHLESS, MeshlessOptions


class MeshlessSolver:
    """A body without elements; takes the place of `physgnn.mechanics.Solver`.

    Parameters
    ----------
    body : Body
        What is loaded; its element is not used.
    options : MeshlessOptions

    Raises
    ------
    InputError
        If the mesh is one layer of points.
    """

    def __init__(
        self, body: Body, *, options: MeshlessOptions = DEFAULT_MESHLESS
    ) -> None:
        self._body, self._options = body, options
        self._elements = make_elements(body.mesh, body.materials)
        self._approximation = make_approximation(body.mesh, options)
        mesh, law = body.mesh, body.materials
        modulus = np.array(
            [3 * law[r].lam + 2 * law[r].mu for r in mesh.region.tolist()]
        )
        at = self._approximation.integration
        self._mass = scaled_mass(at, mesh.n_points, mesh.cell_volumes * modulus)

    def solve(self, path: LoadPath) -> Solution:
        """Bring the body to rest at every level of a path.

        Returns
        -------
        Solution
            The approximated displacement of the mesh's points. A level that was not
            reached has a status that says why.

        Raises
        ------
        InputError
            If a loaded node is missing from the mesh or fixed, or fixed points and
            prescribed displacements together leave a part of the body free to move.
        """
        record = LevelRecord(path, self._body.mesh.n_points)
        loaded = LoadedBody(
            self._body,
            path,
            elements=self._elements,
            approximation=self._approximation,
            mass=self._mass,
            options=self._options,
        )
        walk, message = _Walk(loaded, self._options.min_step), ""
        for level, target in enumerate(path.load_factors.tolist()):
            found = walk.advance(target)
            if found.status != Status.CONVERGED:
                record.stop(level, found.status)
                message = found.status.stopped_at(walk.reached, found.inverted)
                break
            displacement = self._approximation.shape @ found.state
            record.keep(level, displacement, found.residual)
        return record.solution(
            reached=walk.reached,
            message=message,
            counts={"time_steps": loaded.n_steps},
        )


class _Walk:
    """From rest along the levels of a path, in smaller steps where cells invert."""

    def __init__(self, loaded: LoadedBody, min_step: float) -> None:
        self._loaded, self._min_step = loaded, min_step
        self._history = PathHistory(0.0, loaded.undeformed())
        self._trusted = np.inf

    @property
    def reached(self) -> float:
        """The load factor of the last state at rest."""
        return self._history.newest[0]

    def advance(self, target: float) -> SettledState:
        """Go to a load factor; only cells that invert on the way call for less."""
        step = min(target - self.reached, self._trusted)
        while True:
            goal = target if self.reached + 1.5 * step > target else self.reached + step
            found = self._loaded.come_to_rest(self._history.predict(goal), goal)
            if found.status == Status.CONVERGED:
                step = self._trusted = 2 * (goal - self.reached)
                self._history.add(goal, found.state)
                if goal == target:
                    return found
                continue
            step = self._trusted = (goal - self.reached) / 2
            if found.status != Status.INVERTED or step < self._min_step:
                return found

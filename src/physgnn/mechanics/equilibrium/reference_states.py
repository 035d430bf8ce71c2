"""Reference states: equilibria found before, and the linear response about each."""

from collections.abc import Callable
from dataclasses import dataclass

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.linear.direct_solver import factorized
from physgnn.mechanics.linear.protocols import LinearSolver


@dataclass(frozen=True, eq=False)
class ReferenceState:
    """A stable equilibrium under some load.

    Attributes
    ----------
    displacement : (n_points, 3) array
        mm.
    respond : callable
        From forces (n_points, 3) in N to K(u)⁻¹ f in mm.
    """

    displacement: FloatArray
    respond: Callable[[FloatArray], FloatArray]

    @classmethod
    def of(cls, body: Body, displacement: FloatArray) -> "ReferenceState":
        """Return a state that is factorised when its response is first asked for."""
        solver: LinearSolver | None = None

        def respond(force: FloatArray) -> FloatArray:
            nonlocal solver
            solver = _factorized(body, displacement) if solver is None else solver
            pattern = body.pattern
            return pattern.on_points(solver.solve(pattern.unknowns(force)))

        return cls(displacement, respond)


# From a load's forces (n_points, 3), N, to the reference state under the nearest load.
NearestReference = Callable[[FloatArray], ReferenceState]


def _factorized(body: Body, displacement: FloatArray) -> LinearSolver:
    solver = factorized(body, displacement, precision="single")
    if solver is None:
        raise InputError(
            "a reference state is not a stable equilibrium: fix at least three points "
            "that are not in line, or train again"
        )
    return solver

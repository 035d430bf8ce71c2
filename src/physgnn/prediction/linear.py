"""Linear elasticity, u = K₀⁻¹ f: the baseline no network may lose to."""

from physgnn.mechanics.body import Body
from physgnn.mechanics.rest_state import RestState
from physgnn.prediction.prediction import Answer


def linear_answer(body: Body) -> Answer:
    """Return the linear solution as a function from load case to displacement.

    The factorisation of K₀ is done here, once; an answer costs one back-solve.
    """
    rest = RestState(body)
    return lambda case: rest.solve(case.on_points(body.mesh.n_points))

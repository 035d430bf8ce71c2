"""Linear regression for all nodes (Lorente et al. 2017)."""

from physgnn.learning.classical.estimators.linear_rows import LinearRows
from physgnn.learning.classical.learners.nodal_learner import NodalLearner
from physgnn.mechanics.body import Body


class LinearRegression(NodalLearner):
    """A linear map from a node and the load to the node's displacement.

    Parameters
    ----------
    body : Body
        What is loaded.
    penalty : float
        On the squared coefficients of the standardised inputs.
    """

    def __init__(self, body: Body, *, penalty: float = 1e-6) -> None:
        super().__init__(body, lambda _: LinearRows(penalty))

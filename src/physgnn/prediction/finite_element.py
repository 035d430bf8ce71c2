"""The full finite-element solve behind the same interface as every predictor."""

import time

from physgnn.choices import Estimate
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.equilibrium.warm_start import WarmStartSolver
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.prediction import ErrorBound, Prediction, PredictionStatus
from physgnn.prediction.repair_policy import SAFETY

TOLERANCE_MM = 1e-3  # of a solve nobody gives a tolerance for


class FiniteElementPredictor:
    """Solves every load case from rest.

    Parameters
    ----------
    body : Body
        Mesh, materials and fixed points.
    threads : int
        Of the linear solver.
    """

    def __init__(self, body: Body, *, threads: int = 1) -> None:
        self._warm_start = WarmStartSolver(body, threads=threads)

    def __call__(
        self,
        load_case: LoadCase,
        *,
        tolerance_mm: float | None = None,
        estimate: str = Estimate.PHYSICAL,  # noqa: ARG002
    ) -> Prediction:
        """Return the finite-element solution.

        Its error estimate is the solver's own tolerance, whatever estimate is asked.
        Where the load is not reached, the status is TOLERANCE_NOT_MET and the
        displacement that of the last equilibrium on the way to it.
        """
        start = time.perf_counter()
        within = TOLERANCE_MM if tolerance_mm is None else tolerance_mm / SAFETY
        found = self._warm_start.solve(load_case, tolerance_mm=within)
        whole = found.status == Status.CONVERGED
        return Prediction(
            displacement=found.displacement,
            error_estimate_mm=ErrorBound(within, within, 1.0) if whole else None,
            status=PredictionStatus.OK if whole else PredictionStatus.TOLERANCE_NOT_MET,
            seconds=time.perf_counter() - start,
            reasons=() if whole else (found.status.remedy,),
        )

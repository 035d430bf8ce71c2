"""The full finite-element solve behind the same interface as every predictor."""

import time

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.choices import Estimate
from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.equilibrium.solver import Solver, SolverOptions
from physgnn.mechanics.equilibrium.warm_start import WarmStartSolver
from physgnn.mechanics.loads.paths import LoadCase, LoadPath
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
        seconds = time.perf_counter() - start
        return _solved(found.displacement, found.status, within, seconds)


def solve_by_finite_elements(
    body: Body, path: LoadPath, *, tolerance_mm: float
) -> Prediction:
    """Return the equilibrium at the end of a path of any loads.

    Parameters
    ----------
    body : Body
        Mesh, materials and fixed points.
    path : LoadPath
        Also of loads that no surrogate knows, such as growth.
    tolerance_mm : float
        The largest nodal error wanted, > 0.

    Returns
    -------
    Prediction
        TOLERANCE_NOT_MET, with a displacement of nothing, if the load is not reached.

    Raises
    ------
    InputError
        If the path does not fit the body or the tolerance is not positive.
    """
    if not 0 < tolerance_mm < np.inf:
        raise InputError(f"tolerance_mm must be > 0 and finite (got {tolerance_mm})")
    within = tolerance_mm / SAFETY
    found = Solver(body, options=SolverOptions(tolerance_mm=within)).solve(path)
    last, status = found.displacement[-1], Status(int(found.status[-1]))
    return _solved(last, status, within, found.seconds)


def _solved(
    displacement: FloatArray, status: Status, within_mm: float, seconds: float
) -> Prediction:
    whole = status == Status.CONVERGED
    return Prediction(
        displacement=displacement,
        error_estimate_mm=ErrorBound(within_mm, within_mm, 1.0) if whole else None,
        status=PredictionStatus.OK if whole else PredictionStatus.TOLERANCE_NOT_MET,
        seconds=seconds,
        reasons=() if whole else (status.remedy,),
    )

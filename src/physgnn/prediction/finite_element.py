"""The full finite-element solve behind the same interface as every predictor."""

import time

import numpy as np

from physgnn.learning.interface import Body
from physgnn.mechanics.loads import LoadCase, LoadPath
from physgnn.mechanics.solution import Status
from physgnn.mechanics.solver import DEFAULT_OPTIONS, Solver
from physgnn.prediction.prediction import ErrorEstimate, Prediction, PredictionStatus

N_LEVELS = 5  # a start for the solver's path following, which refines it where needed


class FiniteElementPredictor:
    """Solves every load case along a short load path.

    Parameters
    ----------
    body : Body
        Mesh, materials and fixed points.
    """

    def __init__(self, body: Body) -> None:
        self._n_points = body.mesh.n_points
        self._solver = Solver(body.mesh, body.materials, body.fixed)

    def __call__(
        self, load_case: LoadCase, *, tolerance_mm: float | None = None
    ) -> Prediction:
        """Return the finite-element solution, whatever the tolerance.

        Its error estimate is the solver's own tolerance. Where the solve stops short,
        the status is TOLERANCE_NOT_MET and the displacement that of the last level in
        equilibrium.
        """
        del tolerance_mm
        start = time.perf_counter()
        factors = np.arange(1, N_LEVELS + 1) / N_LEVELS
        path = LoadPath(load_case.nodes, load_case.forces, factors)
        solution = self._solver.solve(path)
        solved = np.flatnonzero(solution.status == Status.CONVERGED)
        displacement = (
            solution.displacement[solved[-1]]
            if len(solved)
            else np.zeros((self._n_points, 3))
        )
        within = DEFAULT_OPTIONS.tolerance_mm
        whole = bool(solution.status[-1] == Status.CONVERGED)
        return Prediction(
            displacement=displacement,
            error_estimate_mm=ErrorEstimate(within, within, 1.0) if whole else None,
            status=PredictionStatus.OK if whole else PredictionStatus.TOLERANCE_NOT_MET,
            seconds=time.perf_counter() - start,
        )

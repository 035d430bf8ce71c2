"""The run's predictor with its one avoidable back-solve replaced by a product.

The exposed nodes are few, so K₀⁻¹ restricted to loads on them is a matrix that fits in
memory: the linear solution is a product with some of its columns, several times faster
than a back-solve, which is what a calibrated network otherwise spends a third of its
time on.
"""

import time

import numpy as np
from numpy.typing import NDArray

from physgnn.learning.interface import Body
from physgnn.mechanics.loads import LoadCase
from physgnn.mechanics.rest_state import RestState
from physgnn.prediction.linear import linear_answer
from physgnn.prediction.prediction import (
    Answer,
    Predict,
    Prediction,
    PredictionStatus,
)
from physgnn.prediction.predictor import Predictor

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MAX_BYTES = 200_000_000
BATCH = 8  # nodes, three right-hand sides each, solved at once


def linear_on(body: Body, nodes: IntArray) -> Answer:
    """Return the linear solution for loads on these nodes, as a product.

    Where the matrix would be too large it is a back-solve, for any load.

    Parameters
    ----------
    body : Body
        What is loaded.
    nodes : (n,) integer array
        The only ones that may be loaded.
    """
    if 3 * body.mesh.n_points * 3 * len(nodes) * 4 > MAX_BYTES:
        return linear_answer(body)
    columns = _columns(body, nodes)
    place = np.full(body.mesh.n_points, -1)
    place[nodes] = np.arange(len(nodes))

    def answer(case: LoadCase) -> FloatArray:
        rows = columns[place[case.nodes]]
        flat = rows.reshape(-1, rows.shape[-1])
        product = case.forces.astype(np.float32).ravel() @ flat
        displacement: FloatArray = product.reshape(-1, 3).astype(np.float64)
        return displacement

    return answer


def live_predictor(network: Predictor, linear: Answer) -> Predict:
    """Return a run's predictor that takes the linear solution from `linear`.

    Its answers are the run's own, and its estimates to rounding.
    """
    calibration = network.calibration
    if calibration is None or calibration.indicator != "correction":
        return network

    def predict(
        load_case: LoadCase, *, tolerance_mm: float | None = None
    ) -> Prediction:
        if tolerance_mm is not None:
            return network(load_case, tolerance_mm=tolerance_mm)
        start = time.perf_counter()
        displacement = network.answer(load_case)
        estimate = calibration.estimate(displacement - linear(load_case))
        outside = calibration.trained_range.reasons_outside(load_case)
        return Prediction(
            displacement,
            estimate,
            PredictionStatus.OUTSIDE_TRAINED_RANGE if outside else PredictionStatus.OK,
            time.perf_counter() - start,
        )

    return predict


def _columns(body: Body, nodes: IntArray) -> NDArray[np.float32]:
    """Return K₀⁻¹ for unit forces on nodes, (n, 3, 3 · n_points)."""
    rest = RestState(body.mesh, body.materials, body.fixed)
    n_points = body.mesh.n_points
    columns = np.empty((len(nodes), 3, 3 * n_points), dtype=np.float32)
    for start in range(0, len(nodes), BATCH):
        some = nodes[start : start + BATCH]
        forces = np.zeros((len(some), 3, n_points, 3))
        for i, node in enumerate(some):
            forces[i, :, node] = np.eye(3)
        solved = rest.solve(forces.reshape(-1, n_points, 3))
        columns[start : start + len(some)] = solved.reshape(len(some), 3, -1)
    return columns

"""From a load case to a displacement with an error estimate and a status."""

import time
from functools import cached_property
from pathlib import Path

import numpy as np
import torch

from physgnn.dataset.split import Split
from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.learning.checkpoint import Checkpoint
from physgnn.learning.interface import Body, Model
from physgnn.mechanics.loads import LoadCase
from physgnn.prediction.calibration import Calibration, calibrate
from physgnn.prediction.finite_element import FiniteElementPredictor
from physgnn.prediction.indicators import INDICATORS
from physgnn.prediction.prediction import (
    Answer,
    ErrorEstimate,
    FloatArray,
    Prediction,
    PredictionStatus,
)
from physgnn.progress import Progress

CALIBRATION_FILE = "calibration.json"


class Predictor:
    """Answers load cases by a function, checks the answer, and repairs it if asked.

    Parameters
    ----------
    body : Body
        Mesh, materials and fixed points.
    answer : callable
        From a LoadCase to the displacement (n_points, 3), mm.
    calibration : Calibration, optional
        Gives the error estimate and the trained range; without it a prediction
        carries no estimate, and any `tolerance_mm` calls for the full solve.
    """

    def __init__(
        self, body: Body, answer: Answer, *, calibration: Calibration | None = None
    ) -> None:
        self.body = body
        self.answer = answer
        self.calibration = calibration
        self._indicator = (
            INDICATORS[calibration.indicator](body) if calibration else None
        )

    @classmethod
    def load(cls, run: str | Path, *, device: str = "cpu") -> "Predictor":
        """Load the model of a run folder, with its calibration if there is one.

        Raises
        ------
        InputError
            If the folder holds no checkpoint, or one of another version.
        """
        run = Path(run)
        model = Checkpoint.load(run).model
        file = run / CALIBRATION_FILE
        calibration = Calibration.read(file) if file.is_file() else None
        return cls(
            model.body, network_answer(model, device=device), calibration=calibration
        )

    def __call__(
        self, load_case: LoadCase, *, tolerance_mm: float | None = None
    ) -> Prediction:
        """Return the displacement under a load case.

        Parameters
        ----------
        load_case : LoadCase
            Forces in N.
        tolerance_mm : float, optional
            The largest nodal error wanted. Where the estimate is above it, or promises
            nothing, the full finite-element solve answers instead.

        Raises
        ------
        InputError
            If the load does not fit the mesh, or the tolerance is not positive.
        """
        start = time.perf_counter()
        load_case.check_against(self.body.mesh, self.body.fixed)
        if tolerance_mm is not None and not tolerance_mm > 0:
            raise InputError(f"tolerance_mm must be > 0 (got {tolerance_mm})")
        displacement = self.answer(load_case)
        estimate = self._estimate(load_case, displacement)
        status = self._status(load_case)
        if tolerance_mm is not None and not (
            status.usable and estimate and estimate.max_mm <= tolerance_mm
        ):
            return self._repaired(load_case, start)
        seconds = time.perf_counter() - start
        return Prediction(displacement, estimate, status, seconds)

    def _estimate(
        self, load_case: LoadCase, displacement: FloatArray
    ) -> ErrorEstimate | None:
        if self.calibration is None or self._indicator is None:
            return None
        return self.calibration.estimate(self._indicator(load_case, displacement))

    def _status(self, load_case: LoadCase) -> PredictionStatus:
        if self.calibration and self.calibration.trained_range.reasons_outside(
            load_case
        ):
            return PredictionStatus.OUTSIDE_TRAINED_RANGE
        return PredictionStatus.OK

    def _repaired(self, load_case: LoadCase, start: float) -> Prediction:
        solved = self._solve(load_case)
        status = PredictionStatus.SOLVED if solved.status.usable else solved.status
        seconds = time.perf_counter() - start
        return Prediction(
            solved.displacement, solved.error_estimate_mm, status, seconds
        )

    @cached_property
    def _solve(self) -> FiniteElementPredictor:
        return FiniteElementPredictor(self.body)


def network_answer(model: Model, *, device: str = "cpu") -> Answer:
    """Return a model as a function from load case to displacement."""
    model = model.to(device).eval()
    graph = model.body.graph.to(device)

    @torch.inference_mode()
    def answer(load_case: LoadCase) -> FloatArray:
        inputs = model.encode(load_case).to(device).unsqueeze(0)
        displacement: FloatArray = model(inputs, graph)[0].cpu().numpy()
        return displacement.astype(np.float64)

    return answer


def calibrate_run(
    run: str | Path,
    store: Store,
    split: Split,
    *,
    indicator: str = "correction",
    coverage: float = 0.9,
    progress: Progress | None = None,
) -> Calibration:
    """Calibrate the model of a run on the validation set and store the result there.

    Parameters
    ----------
    run : path
        Folder of a trained model.
    store, split : Store, Split
        What it was trained on.
    indicator : str
        Row of `indicators.INDICATORS`.
    coverage : float
        Wanted coverage of the error bounds.
    progress : callable, optional
        Called with (done, total, text) after every sample.
    """
    predictor = Predictor.load(run)
    calibration = calibrate(
        predictor.answer,
        (indicator, INDICATORS[indicator](predictor.body)),
        store,
        (split.train, split.validation),
        coverage=coverage,
        progress=progress,
    )
    calibration.write(Path(run) / CALIBRATION_FILE)
    return calibration

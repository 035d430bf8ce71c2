"""From a load case to a displacement with an error estimate and a status."""

import time
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path

import numpy as np
import torch

from physgnn.dataset.split import Split
from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.learning.checkpoint import Checkpoint
from physgnn.learning.interface import Body, Model
from physgnn.learning.lifted import LiftedModel, body_axes
from physgnn.mechanics.approach import Approach
from physgnn.mechanics.element import internal_force, make_elements
from physgnn.mechanics.loads import LoadCase
from physgnn.mechanics.solution import Status
from physgnn.prediction.calibration import Calibration, calibrate
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
TINY_N = 1e-6  # leaves the rest state the nearest
SAFETY = 10.0  # a repair's own estimate must be so much below the tolerance
REPAIRS = {
    "guess": PredictionStatus.REPAIRED,
    "known": PredictionStatus.REPAIRED,
    "rest": PredictionStatus.SOLVED,
    "path": PredictionStatus.SOLVED,
}


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
        carries no estimate, and any `tolerance_mm` calls for a repair.
    known : (n_known, n_points, 3) array, optional
        Stable equilibria that repairs may start from, mm.
    linear : callable, optional
        A quick way to K₀⁻¹ f, if there is one, for the indicator.
    """

    def __init__(
        self,
        body: Body,
        answer: Answer,
        *,
        calibration: Calibration | None = None,
        known: FloatArray | None = None,
        linear: Answer | None = None,
    ) -> None:
        self.body = body
        self._known = known
        self.linear = linear
        self.answer = answer
        self.calibration = calibration
        self._indicator = (
            INDICATORS[calibration.indicator](body, linear) if calibration else None
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
        predictor = cls(
            model.body,
            network_answer(model, device=device),
            calibration=calibration,
            known=known_states(model),
            linear=quick_linear(model),
        )
        predictor.warm_up()
        return predictor

    def warm_up(self) -> None:
        """Have first answers over with: they factorise, compile and allocate."""
        for case in anchor_cases(self.body, self._known):
            self(case)

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
            nothing, the answer is taken to the finite-element equilibrium.

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
            return self._repaired(load_case, displacement, tolerance_mm, start)
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

    def _repaired(
        self, case: LoadCase, guess: FloatArray, tolerance_mm: float, start: float
    ) -> Prediction:
        within = tolerance_mm / SAFETY
        found = self._approach.solve(case, guess, tolerance_mm=within)
        if found.status == Status.CONVERGED:
            status, estimate = REPAIRS[found.origin], ErrorEstimate(within, within, 1.0)
        else:
            status, estimate = PredictionStatus.TOLERANCE_NOT_MET, None
        seconds = time.perf_counter() - start
        return Prediction(found.displacement, estimate, status, seconds)

    @cached_property
    def _approach(self) -> Approach:
        body = self.body
        return Approach(body.mesh, body.materials, body.fixed, known=self._known)


def known_states(model: Model) -> FloatArray:
    """Return the equilibria a model carries with it, (n_known, n_points, 3), mm."""
    if not isinstance(model, LiftedModel):
        return np.empty((0, model.body.mesh.n_points, 3))
    states = model.anchor_states.cpu().numpy().astype(np.float64)
    return states @ body_axes(model.body.mesh)


def quick_linear(model: Model) -> Answer | None:
    """Return the linear answer that a model keeps for itself, if it does."""
    return model.linear if isinstance(model, LiftedModel) else None


def anchor_cases(body: Body, known: FloatArray | None) -> Iterator[LoadCase]:
    """Yield the load each known state is in equilibrium with, and a tiny one."""
    elements = make_elements(body.mesh, body.materials)
    free = np.setdiff1d(np.arange(body.mesh.n_points), body.fixed)
    yield LoadCase(free[:1], np.full((1, 3), TINY_N))
    for state in () if known is None else known:
        force, inverted = internal_force(elements, state)
        if inverted < 0 and force[free].any():
            yield LoadCase(free, force[free])


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
        (indicator, INDICATORS[indicator](predictor.body, predictor.linear)),
        store,
        (split.train, split.validation),
        coverage=coverage,
        progress=progress,
    )
    calibration.write(Path(run) / CALIBRATION_FILE)
    return calibration

"""From a load case to a displacement with an error estimate and a status."""

import logging
import time
from functools import cached_property
from pathlib import Path

import numpy as np
import torch

from physgnn.arrays import FloatArray
from physgnn.choices import Estimate
from physgnn.errors import InputError
from physgnn.io.integrity.digest import Manifest
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.parts import REMEDY, read_manifest
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics.equilibrium.relaxation import Relaxation
from physgnn.mechanics.equilibrium.warm_start import WarmStartSolver
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.error_bounds.calibration import Calibration
from physgnn.prediction.error_bounds.indicators import INDICATORS
from physgnn.prediction.evidence import Evidence, Verdict, decide
from physgnn.prediction.prediction import ErrorBound, LikelyError, Prediction
from physgnn.prediction.repair_policy import (
    cautious_error,
    good_enough,
    repair,
    where_to_begin,
)


class Predictor:
    """Predicts by a surrogate, says how far to trust it, and repairs it if asked.

    Parameters
    ----------
    surrogate : Surrogate
        Gives displacements, and the reference states that estimates and repairs may
        start from. Loads it has no sound displacement for count as outside the trained
        range, and a repair does not begin there.
    calibration, relaxation : Calibration, optional
        Give the error bounds, from a cheap indicator and from the physical estimate,
        and the trained range. Without the first a prediction carries no bounds unless
        asked for the physical estimate, and any `tolerance_mm` calls for a repair; with
        the quick estimate its status is NO_ERROR_ESTIMATE then.
    """

    def __init__(
        self,
        surrogate: Surrogate,
        *,
        calibration: Calibration | None = None,
        relaxation: Calibration | None = None,
    ) -> None:
        self.surrogate, self.body = surrogate, surrogate.body
        self.calibration = calibration
        self.relaxation = relaxation
        self._indicator = None
        if calibration is not None:
            if calibration.indicator not in INDICATORS:
                raise InputError(
                    f"the calibration's indicator must be one of "
                    f"{', '.join(INDICATORS)} (got '{calibration.indicator}'): "
                    "calibrate the run again"
                )
            self._indicator = INDICATORS[calibration.indicator](surrogate)

    @classmethod
    def load(
        cls,
        run: str | Path,
        *,
        device: str = "cpu",
        precision: str = "float32",
        warm: bool = True,
    ) -> "Predictor":
        """Load the model of a run folder, with its calibration if there is one.

        Parameters
        ----------
        run : path
            Folder of a trained model.
        device : str
            As torch names it.
        precision : {"float32", "bfloat16"}
            Of a PhysGNN's largest products; the processor should be made for it.
        warm : bool
            The first predictions factorise, compile and allocate: make them now. A
            single prediction needs but one factor of several, and is sooner without.

        Raises
        ------
        InputError
            If the folder holds no checkpoint, or one of another version, or the model
            has nothing that the precision would change.
        """
        files = RunFolder(Path(run))
        surrogate = Checkpoint.load(run).model
        surrogate.prepare(device=device, precision=precision)
        predictor = cls(
            surrogate,
            calibration=_read_if_there(files.calibration),
            relaxation=_read_if_there(files.relaxation),
        )
        for case in surrogate.warm_up_cases() if warm else ():
            predictor(case, estimate=Estimate.QUICK)
        return predictor

    def __call__(
        self,
        load_case: LoadCase,
        *,
        tolerance_mm: float | None = None,
        estimate: str = Estimate.PHYSICAL,
    ) -> Prediction:
        """Return the displacement under a load case.

        Parameters
        ----------
        load_case : LoadCase
            Forces in N.
        tolerance_mm : float, optional
            The largest nodal error wanted. Where the physical estimate, doubled, or the
            bound is above it, or they promise nothing, the prediction is taken to the
            finite-element equilibrium.
        estimate : str
            One of `physgnn.choices.Estimate`: "physical" says how large the error
            seems, and bounds it sharply, by a few steps of the solver; "quick" bounds
            it more coarsely within milliseconds.

        Raises
        ------
        InputError
            If the load does not fit the mesh, the tolerance is not positive or the
            estimate unknown.
        """
        begun = time.perf_counter()
        load_case.check_against(self.body.mesh, self.body.fixed)
        if tolerance_mm is not None and not 0 < tolerance_mm < np.inf:
            raise InputError(
                f"tolerance_mm must be > 0 and finite (got {tolerance_mm})"
            )
        if estimate not in [*Estimate]:
            raise InputError(
                f"estimate must be one of {', '.join(Estimate)} (got {estimate})"
            )
        displacement = self.surrogate.predict(load_case)
        if estimate == Estimate.QUICK and tolerance_mm is None:
            bounds, likely = self._quick(load_case, displacement), None
            verdict = self._judge(load_case, displacement, bounds)
        else:
            relaxed = self.relax(load_case, displacement)
            error = cautious_error(self.body, load_case, relaxed)
            bounds, likely = self._physical(load_case, displacement, error)
            verdict = self._judge(load_case, displacement, bounds, likely, tolerance_mm)
            if tolerance_mm is not None and not (
                verdict.status.usable
                and not self._outside(load_case)
                and good_enough(bounds, likely, tolerance_mm)
            ):
                displacement, bounds, verdict = self._repaired(
                    load_case, relaxed, tolerance_mm
                )
                likely = None
        seconds = time.perf_counter() - begun
        return Prediction(
            displacement, bounds, verdict.status, seconds, likely, verdict.reasons
        )

    def error(self, load_case: LoadCase, displacement: FloatArray) -> FloatArray:
        """Return the physical estimate of a prediction's error, (n_points, 3), mm."""
        relaxed = self.relax(load_case, displacement)
        return cautious_error(self.body, load_case, relaxed)

    def relax(self, load_case: LoadCase, displacement: FloatArray) -> Relaxation:
        """Take a few steps towards equilibrium: they tell a displacement's error."""
        if not np.isfinite(displacement).all():
            nowhere = np.full_like(displacement, np.nan)
            return Relaxation(nowhere, nowhere, nowhere)
        return self._warm_start.relax(load_case, displacement)

    def indicate(self, load_case: LoadCase, displacement: FloatArray) -> FloatArray:
        """Return the quick indicator of a displacement's error, (n_points, 3), mm.

        Raises
        ------
        InputError
            If the predictor is not calibrated.
        """
        if self._indicator is None:
            raise InputError("the predictor is not calibrated: train its run again")
        return self._indicator(load_case, displacement)

    def _quick(
        self, load_case: LoadCase, displacement: FloatArray
    ) -> ErrorBound | None:
        if self.calibration is None:
            return None
        return self.calibration.estimate(self.indicate(load_case, displacement))

    def _physical(
        self, load_case: LoadCase, displacement: FloatArray, error: FloatArray
    ) -> tuple[ErrorBound | None, LikelyError]:
        length = np.linalg.norm(error, axis=1)
        likely = LikelyError(float(length.mean()), float(length.max()))
        if self.relaxation is None:
            return self._quick(load_case, displacement), likely
        return self.relaxation.estimate(error), likely

    def _judge(
        self,
        load_case: LoadCase,
        displacement: FloatArray,
        bounds: ErrorBound | None,
        likely: LikelyError | None = None,
        tolerance_mm: float | None = None,
    ) -> Verdict:
        """Decide what the prediction is called."""
        squares = np.einsum("ni,ni->n", displacement, displacement)
        return decide(
            Evidence(
                largest_mm=float(np.sqrt(squares.max())),
                bound_mm=None if bounds is None else bounds.max_mm,
                likely_mm=None if likely is None else likely.max_mm,
                tolerance_mm=tolerance_mm,
                outside=self._outside(load_case),
                sound=self.surrogate.is_sound(load_case),
            )
        )

    def _outside(self, load_case: LoadCase) -> tuple[str, ...]:
        """Return why a load is unlike those trained on; empty if that is not known."""
        calibration = self.calibration or self.relaxation
        if calibration is None:
            return ()
        return tuple(calibration.trained_range.reasons_outside(load_case))

    def _repaired(
        self, load_case: LoadCase, relaxed: Relaxation, tolerance_mm: float
    ) -> tuple[FloatArray, ErrorBound | None, Verdict]:
        """Take a prediction to the finite-element equilibrium."""
        sound = self.surrogate.is_sound(load_case)
        start = where_to_begin(
            self.surrogate.predict if sound else None,
            self.body,
            load_case,
            relaxed.displacement,
        )
        displacement, bounds, status = repair(
            self._warm_start, load_case, start, tolerance_mm
        )
        reasons = () if status.usable else ("the solve did not reach this load",)
        return displacement, bounds, Verdict(status, reasons)

    @cached_property
    def _warm_start(self) -> WarmStartSolver:
        known, threads = self.surrogate.reference_states(), torch.get_num_threads()
        return WarmStartSolver(self.body, nearest=known, threads=threads)


def _read_if_there(file: Path) -> Calibration | None:
    if file.is_file():
        return Calibration.read(file)
    if file.name in (read_manifest(file.parent) or Manifest()).parts:
        logging.getLogger(__name__).warning(
            "physgnn: %s has lost its %s: without it no error bound is given, and "
            "nothing tells loads outside the trained range; %s",
            *(file.parent, file.name, REMEDY),
        )
    return None

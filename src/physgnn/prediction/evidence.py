"""From what is known about a displacement to its status: one function decides.

A displacement is called ok only where something positive speaks for it: a calibrated
bound or the physical estimate of its error, and for a registration a measurement that
is large enough, near enough and met to within its noise.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from physgnn.prediction.measured_evidence import (
    LARGEST_OUTLIER_SHARE,
    LEAST_CHANCE,
    LEAST_SPREAD_MM,
    MeasurementFit,
)
from physgnn.prediction.status import PredictionStatus

# An error is small below either; benchmarks/statuses.py counts their mistakes.
SMALL_MM = 0.5
SMALL_OF_DISPLACEMENT = 0.1
# Cortical shifts of up to 24 mm were seen in 64 patients (Nimsky et al. 2000,
# Neurosurgery 47, 1070-1080).
LARGEST_SHIFT_MM = 40.0
# Brain tissue hardly changes its volume. In simulated shifts of 5 to 12 mm det F is
# between 0.86 and 1.12 when registered (docs/results/registration.md).
SMALLEST_JACOBIAN, LARGEST_JACOBIAN = 0.5, 2.0
# A rigid motion has six unknowns, which two points determine; how a brain deforms
# besides has to come from the others (docs/results/registration.md).
FEWEST_PLACES = 6
# A real one sank by 10 mm on average (Roberts et al. 1998, Neurosurgery 43, 749-758).
FARTHEST_SURFACE_MM = 10.0
# A surface that sinks evenly by less is believed; farther in, the skull's rim bends it.
LARGEST_TRANSLATION_MM = 7.5
# Squared misfit of a translation over that of the elastic body: of pairs up to 1.02
# where a tracker moved by 8 mm, 1.3 and more where a brain sank as far, in simulation;
# the weighing of an offset cannot tell one that points inward from sinking.
AS_WELL = 1.05
# From here on it is an offset that was found; below, the bound is of both.
SURE_OF_OFFSET = 0.95
# Opened, a brain sinks: in simulated shifts the exposed surface by more than half of
# the largest displacement (benchmarks/registration_statuses.py). One that moves by more
# than the first, but sinks by a smaller share of it than the second, may have sunk
# under a navigation that is off outward.
MOVED_MM, LEAST_SINKING = 3.0, 0.25


@dataclass(frozen=True)
class Evidence:
    """What is known about a displacement.

    Attributes
    ----------
    largest_mm : float
        Its largest length; NaN if it is not finite.
    bound_mm : float, optional
        Calibrated bound on the largest error.
    likely_mm : float, optional
        Physical estimate of the largest error.
    tolerance_mm : float, optional
        The largest error wanted; by default what is small beside the displacement.
    outside : tuple of str
        Why the load is unlike those trained on, a line each.
    sound : bool
        Whether the surrogate trusts its own displacement.
    converged : bool
        Whether the search for equilibrium ended there.
    jacobian : (float, float), optional
        Smallest and largest det F over cells, where it was computed.
    fit : MeasurementFit, optional
        Of a registration.
    """

    largest_mm: float
    bound_mm: float | None = None
    likely_mm: float | None = None
    tolerance_mm: float | None = None
    outside: tuple[str, ...] = ()
    sound: bool = True
    converged: bool = True
    jacobian: tuple[float, float] | None = None
    fit: MeasurementFit | None = None

    @property
    def wanted_mm(self) -> float:
        """The largest error that is called small."""
        if self.tolerance_mm is not None:
            return self.tolerance_mm
        return max(SMALL_MM, SMALL_OF_DISPLACEMENT * self.largest_mm)

    @property
    def is_small(self) -> bool:
        """Whether the physical estimate says that the error is small."""
        return self.likely_mm is not None and self.likely_mm <= self.wanted_mm


@dataclass(frozen=True)
class Verdict:
    """A status and the reasons for it, one line each; none if it is just ok."""

    status: PredictionStatus
    reasons: tuple[str, ...] = ()


def decide(evidence: Evidence) -> Verdict:
    """Return the status that evidence calls for: the first row of `RULES` that objects.

    The reasons of all rows are listed, those of the status first.
    """
    found = [(status, tuple(rule(evidence))) for status, rule in RULES]
    objections = [(status, reasons) for status, reasons in found if reasons]
    if not objections:
        return _without_objections(evidence)
    return Verdict(
        objections[0][0], tuple(line for _, reasons in objections for line in reasons)
    )


def _without_objections(evidence: Evidence) -> Verdict:
    """Return ok, or what it rests on: an offset that nothing measured would show."""
    hidden = tuple(evidence.fit.hidden_offset()) if evidence.fit is not None else ()
    if not hidden:
        return Verdict(PredictionStatus.OK)
    return Verdict(PredictionStatus.OK_IF_NAVIGATION_IS_RIGHT, hidden)


def _not_converged(evidence: Evidence) -> Iterator[str]:
    if not evidence.converged:
        yield "the search for equilibrium ended early"


def _too_few(evidence: Evidence) -> Iterator[str]:
    fit = evidence.fit
    if fit is None:
        return
    if fit.n_places < FEWEST_PLACES:
        yield f"{fit.n_places} places were measured (at least {FEWEST_PLACES})"
    if not fit.spread_mm >= LEAST_SPREAD_MM:
        yield (
            f"the places spread by {fit.spread_mm:.1f} mm across their longest axis "
            f"(at least {LEAST_SPREAD_MM:g} mm)"
        )


def _too_far(evidence: Evidence) -> Iterator[str]:
    fit = evidence.fit
    if fit is not None and fit.distance_mm > FARTHEST_SURFACE_MM:
        yield (
            f"half of the measured surface is {fit.distance_mm:.1f} mm or more from "
            f"the body's at rest (at most {FARTHEST_SURFACE_MM:g} mm)"
        )
    if fit is not None and fit.exchanged_mm > 0:
        yield (
            f"half of the places before lie {fit.exchanged_mm:.1f} mm or more from the "
            "cortex at rest, those after it less than half as far: are they exchanged?"
        )


def _too_few_of_bone(evidence: Evidence) -> Iterator[str]:
    if evidence.fit is not None and evidence.fit.bone is not None:
        yield from evidence.fit.bone.too_few()


def _bone_misfit(evidence: Evidence) -> Iterator[str]:
    if evidence.fit is not None and evidence.fit.bone is not None:
        yield from evidence.fit.bone.contradictions()


def _moved_as_a_whole(evidence: Evidence) -> Iterator[str]:
    fit = evidence.fit
    if (
        fit is not None
        and fit.bone is None  # which says that the tracker is where it should be
        and fit.chance >= LEAST_CHANCE  # else it is compared with a fit that is none
        and fit.translation_mm > LARGEST_TRANSLATION_MM
        and fit.translation_misfit < AS_WELL
    ):
        yield (
            f"a translation by {fit.translation_mm:.1f} mm explains the measurement as "
            "well as a deformation does"
        )


def _implausible(evidence: Evidence) -> Iterator[str]:
    if not np.isfinite(evidence.largest_mm):
        yield "the displacement is not finite"
    elif evidence.largest_mm > LARGEST_SHIFT_MM:
        yield (
            f"the largest displacement is {evidence.largest_mm:.1f} mm (of a brain at "
            f"most {LARGEST_SHIFT_MM:g} mm)"
        )
    if evidence.jacobian is None:
        return
    smallest, largest = evidence.jacobian
    if smallest < SMALLEST_JACOBIAN or largest > LARGEST_JACOBIAN:
        yield (
            f"cells change their volume by factors from {smallest:.2f} to "
            f"{largest:.2f} (of a brain {SMALLEST_JACOBIAN:g} to {LARGEST_JACOBIAN:g})"
        )


def _misfit(evidence: Evidence) -> Iterator[str]:
    fit = evidence.fit
    if fit is not None and not fit.chance >= LEAST_CHANCE:
        yield (
            "measured and registered places are "
            f"{np.sqrt(max(fit.misfit_ratio, 0.0)):.1f} times as far apart as the "
            "stated noise lets expect"
        )
    if fit is not None and fit.bump_mm > 0:
        yield (
            f"an area of the measured surface is {fit.bump_mm:.1f} mm from the "
            "registered one, in the mean, all to one side"
        )
    if fit is not None and fit.outlier_share > LARGEST_OUTLIER_SHARE:
        yield (
            f"{fit.outlier_share:.0%} of the places lie farther off than the stated "
            f"noise lets expect (at most {LARGEST_OUTLIER_SHARE:.0%})"
        )


def _offset_of_navigation(evidence: Evidence) -> Iterator[str]:
    offset = evidence.fit.offset if evidence.fit is not None else None
    if offset is None or offset.corrected:
        return
    if offset.probability >= SURE_OF_OFFSET:
        yield (
            f"a rigid offset of the navigation of {offset.length_mm:.1f} mm and "
            f"{offset.turn_deg:.1f} degrees explains the measurement better than loads "
            "alone: give --bone, or --rigid-offset"
        )


def _offset_not_told(evidence: Evidence) -> Iterator[str]:
    fit = evidence.fit
    if fit is None or fit.bone is not None or evidence.largest_mm <= MOVED_MM:
        return
    if fit.sunk_mm < LEAST_SINKING * evidence.largest_mm:
        how = "sank" if fit.sunk_mm >= 0 else "rose"
        yield (
            f"what was measured {how} by {abs(fit.sunk_mm):.1f} mm while points moved "
            f"by up to {evidence.largest_mm:.1f} mm: a brain that does not sink and a "
            "navigation that is off look the same"
        )


def _outside(evidence: Evidence) -> Iterator[str]:
    if not evidence.sound:
        yield "the model does not trust its own displacement under this load"
    if not evidence.is_small:
        yield from evidence.outside


def _no_estimate(evidence: Evidence) -> Iterator[str]:
    if evidence.bound_mm is None and evidence.likely_mm is None:
        yield "there is neither a calibrated bound nor a physical estimate of the error"


def _too_large(evidence: Evidence) -> Iterator[str]:
    likely, bound = evidence.likely_mm, evidence.bound_mm
    if likely is not None and not evidence.is_small:
        yield (
            f"the error seems to be {likely:.2g} mm (small is up to "
            f"{evidence.wanted_mm:.2g} mm)"
        )
    if bound is not None and not bound <= max(evidence.largest_mm, SMALL_MM):
        yield (
            f"the bound on the error, {bound:.2g} mm, is larger than the displacement, "
            f"{evidence.largest_mm:.2g} mm"
        )


Rule = Callable[[Evidence], Iterator[str]]

# From what makes a displacement meaningless to what makes it merely uncertain.
RULES: tuple[tuple[PredictionStatus, Rule], ...] = (
    (PredictionStatus.TOO_FEW_POINTS, _too_few),
    (PredictionStatus.BONE_MISFIT, _bone_misfit),
    (PredictionStatus.TOO_FEW_BONE_POINTS, _too_few_of_bone),
    (PredictionStatus.MEASUREMENT_TOO_FAR, _too_far),
    (PredictionStatus.TOLERANCE_NOT_MET, _not_converged),
    (PredictionStatus.MISFIT_ABOVE_NOISE, _misfit),
    (PredictionStatus.MOVED_AS_A_WHOLE, _moved_as_a_whole),
    (PredictionStatus.NAVIGATION_OFFSET, _offset_of_navigation),
    (PredictionStatus.OFFSET_NOT_TOLD, _offset_not_told),
    (PredictionStatus.IMPLAUSIBLE_DISPLACEMENT, _implausible),
    (PredictionStatus.OUTSIDE_TRAINED_RANGE, _outside),
    (PredictionStatus.NO_ERROR_ESTIMATE, _no_estimate),
    (PredictionStatus.ERROR_TOO_LARGE, _too_large),
)

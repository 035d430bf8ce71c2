"""The status that each kind of evidence calls for, row by row."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from physgnn.prediction.evidence import RULES, Evidence, MeasurementFit, decide
from physgnn.prediction.measured_evidence import RigidOffset
from physgnn.prediction.status import PredictionStatus as S

NAN = float("nan")
PREDICTED = Evidence(largest_mm=10.0, bound_mm=1.5, likely_mm=0.8)
QUICK = Evidence(largest_mm=10.0, bound_mm=1.5)
MET = MeasurementFit(
    n_places=40,
    spread_mm=10.0,
    distance_mm=0.2,
    translation_mm=5.0,
    translation_misfit=4.0,
    misfit_ratio=1.0,
    chance=0.5,
)
REGISTERED = Evidence(largest_mm=9.0, bound_mm=5.0, jacobian=(0.9, 1.1), fit=MET)


def offset(
    probability: float, *, corrected: bool = False, unknown_mm: float = 0.0
) -> RigidOffset:
    return RigidOffset(
        translation_mm=np.array([4.0, 0.0, 0.0]),
        rotation_deg=np.array([1.0, 0.0, 0.0]),
        deviation_mm=np.ones(3),
        deviation_deg=np.ones(3),
        centre_mm=np.zeros(3),
        log_ratio=3.0,
        probability=probability,
        change_mm=3.0,
        unknown_mm=unknown_mm,
        corrected=corrected,
    )


EVEN = {"translation_mm": 8.0, "translation_misfit": 1.0}
STRONG = ("9 N in all (trained up to 4 N)",)


@pytest.mark.parametrize(
    ("evidence", "status"),
    [
        (PREDICTED, S.OK),
        (QUICK, S.OK),
        # the physical estimate alone is evidence enough, a small one whatever the range
        (replace(PREDICTED, bound_mm=None), S.OK),
        (replace(PREDICTED, outside=STRONG), S.OK),
        (replace(PREDICTED, likely_mm=1.2, outside=STRONG), S.OUTSIDE_TRAINED_RANGE),
        (replace(QUICK, outside=STRONG), S.OUTSIDE_TRAINED_RANGE),
        (replace(PREDICTED, sound=False), S.OUTSIDE_TRAINED_RANGE),
        # small is 0.5 mm, or a tenth of the displacement, or what was asked for
        (replace(PREDICTED, likely_mm=1.2), S.ERROR_TOO_LARGE),
        (replace(PREDICTED, likely_mm=1.2, tolerance_mm=2.0), S.OK),
        (Evidence(largest_mm=0.1, bound_mm=0.49, likely_mm=0.49), S.OK),
        # nothing says how large the error is
        (Evidence(largest_mm=10.0), S.NO_ERROR_ESTIMATE),
        # a bound larger than the displacement, unless both are tiny
        (replace(QUICK, bound_mm=10.1), S.ERROR_TOO_LARGE),
        (Evidence(largest_mm=0.1, bound_mm=0.49), S.OK),
        (Evidence(largest_mm=0.1, bound_mm=0.51), S.ERROR_TOO_LARGE),
        (replace(QUICK, bound_mm=NAN), S.ERROR_TOO_LARGE),
        # what no brain does
        (replace(PREDICTED, largest_mm=2363.0), S.IMPLAUSIBLE_DISPLACEMENT),
        (replace(PREDICTED, largest_mm=NAN), S.IMPLAUSIBLE_DISPLACEMENT),
        # registrations
        (REGISTERED, S.OK),
        (replace(REGISTERED, converged=False), S.TOLERANCE_NOT_MET),
        (replace(REGISTERED, jacobian=(-0.1, 1.1)), S.IMPLAUSIBLE_DISPLACEMENT),
        (replace(REGISTERED, jacobian=(0.9, 2.1)), S.IMPLAUSIBLE_DISPLACEMENT),
        (replace(REGISTERED, largest_mm=41.0), S.IMPLAUSIBLE_DISPLACEMENT),
        (replace(REGISTERED, bound_mm=9.5), S.ERROR_TOO_LARGE),
    ],
)
def test_what_speaks_for_a_displacement_decides(evidence: Evidence, status: S) -> None:
    verdict = decide(evidence)
    assert verdict.status is status
    assert bool(verdict.reasons) == (status is not S.OK)


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"n_places": 5}, S.TOO_FEW_POINTS),
        ({"spread_mm": 2.5}, S.TOO_FEW_POINTS),
        ({"spread_mm": NAN}, S.TOO_FEW_POINTS),
        ({"distance_mm": 14.0}, S.MEASUREMENT_TOO_FAR),
        ({"exchanged_mm": 2.1}, S.MEASUREMENT_TOO_FAR),
        (EVEN, S.MOVED_AS_A_WHOLE),
        ({"translation_mm": 4.0, "translation_misfit": 1.0}, S.OK),
        # an offset inward looks like sinking: its probability is no excuse
        ({**EVEN, "offset": offset(0.03)}, S.MOVED_AS_A_WHOLE),
        ({**EVEN, "translation_misfit": 1.1}, S.OK),
        ({"bump_mm": 2.5}, S.MISFIT_ABOVE_NOISE),
        ({"translation_mm": 8.0}, S.OK),
        ({"misfit_ratio": 4.7, "chance": 1e-9}, S.MISFIT_ABOVE_NOISE),
        ({"chance": NAN}, S.MISFIT_ABOVE_NOISE),
        # an offset is named where it is nearly sure; else the bound is wide enough
        ({"offset": offset(0.96)}, S.NAVIGATION_OFFSET),
        ({"offset": offset(0.94)}, S.OK),
        ({"offset": offset(0.96, corrected=True)}, S.OK),
        # ok rests on the navigation where nothing measured would show that it is off
        ({"offset": offset(0.03, unknown_mm=2.4)}, S.OK_IF_NAVIGATION_IS_RIGHT),
        ({"offset": offset(0.03, unknown_mm=0.9)}, S.OK),
        ({"offset": offset(0.96, unknown_mm=2.4)}, S.NAVIGATION_OFFSET),
        # 9 mm of displacement, of which the brain sank by less than a quarter
        ({"sunk_mm": 2.2}, S.OFFSET_NOT_TOLD),
        ({"sunk_mm": -1.0}, S.OFFSET_NOT_TOLD),
        ({"sunk_mm": 2.3}, S.OK),
    ],
)
def test_a_measurement_must_carry_its_registration(
    change: dict[str, Any], status: S
) -> None:
    evidence = replace(REGISTERED, fit=replace(MET, **change))
    assert decide(evidence).status is status


def test_all_reasons_are_listed_those_of_the_status_first() -> None:
    few = replace(REGISTERED, fit=replace(MET, n_places=1), bound_mm=20.0)
    verdict = decide(few)
    assert verdict.status is S.TOO_FEW_POINTS
    assert [line.split()[0] for line in verdict.reasons] == ["1", "the"]
    assert "20 mm, is larger than the displacement, 9 mm" in verdict.reasons[1]


def test_a_row_for_every_status_that_is_not_usable() -> None:
    assert {status for status, _ in RULES} == {s for s in S if not s.usable}
    assert [s for s in S if s.usable] == [
        S.OK,
        S.SOLVED,
        S.REPAIRED,
        S.OK_IF_NAVIGATION_IS_RIGHT,
    ]

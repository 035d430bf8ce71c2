"""Everything measured in its place on a body, without the offset that bone tells of."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc

from physgnn.arrays import FloatArray
from physgnn.mechanics.body import Body
from physgnn.prediction.measured_evidence import LEAST_CHANCE, BoneFit, RigidOffset
from physgnn.registration.fit import bone_fit_of
from physgnn.registration.inference.bone_offset import BoneOffset, offset_from_bone
from physgnn.registration.inference.bounds import Alternative
from physgnn.registration.inference.rigid_offset import UNKNOWN, OffsetPrior
from physgnn.registration.inference.rows import middle_of
from physgnn.registration.inference.search import Search
from physgnn.registration.measurements.bone import (
    KIND,
    LPS,
    can_be_in_lps,
    off_brain,
)
from physgnn.registration.measurements.kinds import (
    AnyMeasured,
    Noise,
    left_out_of,
    measurements_of,
    moved,
    noises_of,
    parted,
)
from physgnn.registration.measurements.observation import Measurement
from physgnn.registration.measurements.surfaces import MeasuredWholeSurface
from physgnn.registration.misfits import Misfit, misfits_of


@dataclass(frozen=True, eq=False)
class FoundBone:
    """Points of the bone where they are found, without the offset, mm."""

    labels: tuple[str, ...]
    measured: FloatArray
    kind: str = KIND


@dataclass(frozen=True, eq=False)
class Placed:
    """What was measured of one state.

    Attributes
    ----------
    measured : list of Measurement
        Of the brain.
    noises : list of float
        Of each, mm.
    told : BoneOffset or None
        What points of the bone say of the navigation; it has been taken out.
    prior : OffsetPrior or None
        Of the offset that a search corrects; None if it corrects none.
    left_out : tuple of str
        Pairs that were listed and have no place at one end.
    bone : BoneFit or None
        How well the points of the bone agree, if there were any.
    """

    measured: list[Measurement]
    noises: list[float]
    told: BoneOffset | None
    prior: OffsetPrior | None
    left_out: tuple[str, ...] = ()
    bone: BoneFit | None = None

    @property
    def kinds(self) -> list[str]:
        """What was measured of the brain."""
        return [one.kind for one in self.measured]

    @property
    def corrected(self) -> str:
        """How an offset is corrected, as `factors_of` has it."""
        if self.told is not None:
            return "by bone"
        return "no" if self.prior is None else "estimated"

    def offset(self, search: Search) -> tuple[RigidOffset, list[Alternative]]:
        """Return the offset that a search ended with; posteriors the error is of."""
        if self.told is None:
            return search.offset()
        centre = middle_of(self.measured)
        return self.told.reported(search.fit.posterior, centre), search.alone()

    def bone_with(self, search: Search) -> BoneFit | None:
        """Return the same once a search has ended, which may contradict the bone."""
        if self.bone is None or self.prior is None:
            return None
        left = search.fit.posterior.mean[-6:]  # as many standard deviations
        if chdtrc(len(left), float(left @ left)) >= LEAST_CHANCE:
            return self.bone
        away = (self.prior.axes @ left)[:3]
        return replace(self.bone, contradicted_mm=float(np.linalg.norm(away)))

    def misfits(self, search: Search) -> tuple[Misfit, ...]:
        """Return how far every place is off, those of the bone at the end."""
        fit, told = search.fit, self.told
        brain = misfits_of(self.measured, search.rows(), fit.misfit, fit.weights)
        if told is None:
            return brain
        bone = FoundBone(told.in_scan.labels, told.in_scan.target)
        return brain + misfits_of([bone], told.rows, told.fit.misfit, told.fit.weights)


def placed(
    body: Body,
    given: AnyMeasured | Sequence[AnyMeasured],
    noise_mm: Noise,
    *,
    rigid_offset: bool,
) -> Placed:
    """Return everything measured, in its place on a body.

    Parameters
    ----------
    body : Body
        At rest.
    given, noise_mm, rigid_offset
        As of `physgnn.registration.registrar.Registrar`.

    Raises
    ------
    InputError
        If nothing was measured of the brain, or something cannot be where it is said to
        be.
    """

    def noises(measured: Sequence[Measurement]) -> list[float]:
        return noises_of([one.kind for one in measured], noise_mm)

    brain, bone = parted(body.mesh, given)
    left_out = left_out_of([*brain, *([] if bone is None else [bone])])
    if bone is None:
        measured = measurements_of(body, brain)
        prior = UNKNOWN if rigid_offset else None
        return Placed(measured, noises(measured), None, prior, left_out)
    told = offset_from_bone(bone, noises_of([KIND], noise_mm)[0])
    measured = measurements_of(body, [moved(one, told.motion.undone) for one in brain])
    middle = middle_of(measured)
    # A whole surface tells the offset, and so contradicts bone of other axes.
    unclear = not bone.axes_known and MeasuredWholeSurface.kind not in [
        one.kind for one in measured
    ]
    in_lps = unclear and can_be_in_lps(body.mesh, bone)
    fit = replace(
        bone_fit_of(told),
        off_brain_mm=off_brain(body.mesh, bone),
        other_axes_mm=_moved_by_axes(told, middle) if in_lps else 0.0,
    )
    prior = told.prior_about(middle)
    return Placed(measured, noises(measured), told, prior, left_out, fit)


def _moved_by_axes(told: BoneOffset, middle: FloatArray) -> float:
    """Return how far apart the offset puts a place if its points were in LPS, mm."""
    there = LPS * told.motion((LPS * middle)[None])[0]
    return float(np.linalg.norm(there - told.motion(middle[None])[0]))

"""How well a displacement meets what was measured: what a status may rest on."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from physgnn.arrays import FloatArray

LEAST_CHANCE = 1e-3  # of so large a misfit, if noise alone were its cause
# Of the places of one kind; beyond it, nothing says which of them are the bad ones.
LARGEST_OUTLIER_SHARE = 0.2
SAME_PLACE_MM = 1.0  # points nearer to each other than this count once
LEAST_SPREAD_MM = 3.0  # across the line along which the points spread most
FEWEST_BONE_POINTS = 3  # fewer do not tell a rotation
# A whole surface leaves 0.1 mm of a misplaced tracker unknown, what is within a
# craniotomy 2.4 to 6 mm (docs/results/registration.md).
KNOWN_OFFSET_MM = 1.0
# Dura, fluid and the bone's own thickness lie between the cortex and what a pointer
# touches of the skull; a mesh's surface is less than this off.
LEAST_OFF_BRAIN_MM = 2.0


@dataclass(frozen=True, eq=False)
class RigidOffset:
    """A rigid offset of the navigation: how far it seems to be off.

    Attributes
    ----------
    translation_mm : (3,) array
        Along x, y and z, of the middle of what was measured.
    rotation_deg : (3,) array
        About x, y and z through that middle.
    deviation_mm, deviation_deg : (3,) arrays
        Standard deviations of these, given the data.
    centre_mm : (3,) array
        The middle.
    log_ratio : float
        Logarithm of how much more probable the data are with an offset, to the power
        that counts.
    probability : float
        Of an offset, given the data.
    change_mm : float
        How far, at most, the displacement of a point is another with an offset.
    unknown_mm : float
        How far a misplaced tracker may be off without the data telling it from a shift:
        a standard deviation, in the direction that they tell least about. 0 where bone
        told the offset.
    corrected : bool
        Whether the displacement is the one with an offset.
    """

    translation_mm: FloatArray
    rotation_deg: FloatArray
    deviation_mm: FloatArray
    deviation_deg: FloatArray
    centre_mm: FloatArray
    log_ratio: float
    probability: float
    change_mm: float
    unknown_mm: float
    corrected: bool

    @property
    def length_mm(self) -> float:
        """Length of the translation."""
        return float(np.linalg.norm(self.translation_mm))

    @property
    def turn_deg(self) -> float:
        """Angle of the rotation."""
        return float(np.linalg.norm(self.rotation_deg))

    def undone(self, points: FloatArray) -> FloatArray:
        """Return where places (n, 3) are that the navigation finds at points, mm."""
        turn = Rotation.from_rotvec(np.deg2rad(self.rotation_deg))
        back = turn.inv().apply(points - self.centre_mm - self.translation_mm)
        found: FloatArray = back + self.centre_mm
        return found

    def __str__(self) -> str:
        done = "corrected" if self.corrected else f"{self.probability:.0%} probable"
        return f"{self.length_mm:.1f} mm, {self.turn_deg:.1f} degrees, {done}"


@dataclass(frozen=True)
class BoneFit:
    """How well points of the bone agree on an offset of the navigation.

    Attributes
    ----------
    n_points : int
        Points that are no outliers; those within 1 mm of each other count once.
    spread_mm : float
        Standard deviation of these along their second principal axis.
    misfit_mm : float
        Root mean square distance from where the offset puts them.
    chance : float
        Probability of a misfit as large, by noise alone.
    outlier_share : float
        Of all points, that the rest contradicts.
    off_brain_mm : float
        How far the points stand off the brain in the scan, in the median.
    other_axes_mm : float
        How far apart the offset is from what it would be if the points were of LPS,
        where such points could be of bone, too; 0 where they could not.
    contradicted_mm : float
        How far from where the bone puts the navigation the brain does, where that is
        more than noise lets expect; else 0.
    """

    n_points: int
    spread_mm: float
    misfit_mm: float
    chance: float
    outlier_share: float
    off_brain_mm: float = float("inf")
    other_axes_mm: float = 0.0
    contradicted_mm: float = 0.0

    def __str__(self) -> str:
        if not self.n_points:
            return "no bone points that agree, not enough to tell it"
        points = (
            "1 bone point" if self.n_points == 1 else f"{self.n_points} bone points"
        )
        short = ", not enough to tell it" if any(self.too_few()) else ""
        return f"{points}, {self.misfit_mm:.1f} mm off{short}"

    def too_few(self) -> Iterator[str]:
        """Yield why the points do not tell a rigid offset, if they do not."""
        if self.n_points < FEWEST_BONE_POINTS:
            yield (
                f"of the bone {self.n_points} different places are known (at least "
                f"{FEWEST_BONE_POINTS})"
            )
        elif not self.spread_mm >= LEAST_SPREAD_MM:
            yield (
                f"the bone points spread by {self.spread_mm:.1f} mm across their "
                f"longest axis (at least {LEAST_SPREAD_MM:g} mm)"
            )

    def contradictions(self) -> Iterator[str]:
        """Yield why the points do not agree on one offset, if they do not."""
        if self.n_points and not self.chance >= LEAST_CHANCE:
            yield (
                f"bone points are {self.misfit_mm:.1f} mm from where a rigid offset "
                "puts them, more than the stated noise lets expect"
            )
        if self.outlier_share > LARGEST_OUTLIER_SHARE:
            yield (
                f"{self.outlier_share:.0%} of the bone points contradict the others "
                f"(at most {LARGEST_OUTLIER_SHARE:.0%})"
            )
        if self.off_brain_mm < LEAST_OFF_BRAIN_MM:
            yield (
                f"half of the bone points lie within {self.off_brain_mm:.1f} mm of the "
                "brain's surface: points of the cortex are no bone"
            )
        if self.contradicted_mm:
            yield (
                "what was measured of the brain puts the navigation "
                f"{self.contradicted_mm:.1f} mm from where the bone does, more than "
                "their noise lets expect: are the bone's ends, or its axes, exchanged?"
            )


@dataclass(frozen=True)
class MeasurementFit:
    """How well a registration meets what was measured.

    Attributes
    ----------
    n_places : int
        Places measured; those within 1 mm of each other count once: see
        `SAME_PLACE_MM`.
    spread_mm : float
        Standard deviation of the places along their second principal axis.
    distance_mm : float
        Median distance of a measured surface from the body's at rest; 0 for pairs.
    translation_mm : float
        Length of the translation that meets the pairs best; 0 for a surface, which
        tells little of how it slides.
    translation_misfit : float
        Squared misfit of that translation over that of the elastic body, each divided
        by its degrees of freedom; infinite for a surface.
    misfit_ratio : float
        Squared misfit over what the stated noise lets expect.
    chance : float
        Probability of a misfit as large, by noise alone.
    outlier_share : float
        Of the places of one kind, at most, that the rest contradicts.
    offset : RigidOffset, optional
        Where an offset of the navigation was looked for.
    sunk_mm : float
        How far what was measured sank into the brain, in the median; infinite where the
        whole surface was measured.
    bump_mm : float
        How far, in the mean, the places of one area lie off to one side, where that is
        more than the stated noise allows; 0 if no area does.
    bone : BoneFit, optional
        Of points of the bone, where there were any: the offset is what they say.
    exchanged_mm : float
        How far pairs begin from the cortex at rest that end on it; 0 if none do.
    """

    n_places: int
    spread_mm: float
    distance_mm: float
    translation_mm: float
    translation_misfit: float
    misfit_ratio: float
    chance: float
    outlier_share: float = 0.0
    offset: RigidOffset | None = None
    sunk_mm: float = float("inf")
    bump_mm: float = 0.0
    bone: BoneFit | None = None
    exchanged_mm: float = 0.0

    def hidden_offset(self) -> Iterator[str]:
        """Yield why an offset of the navigation may be hidden in the displacement."""
        if self.offset is not None and self.offset.unknown_mm > KNOWN_OFFSET_MM:
            yield (
                f"of a misplaced tracker {self.offset.unknown_mm:.1f} mm (a standard "
                "deviation) would look like a shift of the brain"
            )
        if self.bone is not None and self.bone.other_axes_mm > KNOWN_OFFSET_MM:
            yield (
                "the bone points could be in LPS as well, and the navigation is "
                f"{self.bone.other_axes_mm:.1f} mm elsewhere then: check that they are "
                "in RAS, or give them as .fcsv or .mrk.json, which say so"
            )

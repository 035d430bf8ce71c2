"""What a displacement is called, and what to do about it."""

import re
from enum import IntEnum

ARGUMENT = re.compile(r"\b[a-z]+(_[a-z]+)+\b")


class PredictionStatus(IntEnum):
    """How a prediction or a registration ended. The text of each is its remedy.

    It names arguments of the functions; `remedy_for` names a command's options.
    """

    OK = 0
    SOLVED = 1
    OUTSIDE_TRAINED_RANGE = 2
    TOLERANCE_NOT_MET = 3
    REPAIRED = 4
    NO_ERROR_ESTIMATE = 5
    ERROR_TOO_LARGE = 6
    IMPLAUSIBLE_DISPLACEMENT = 7
    TOO_FEW_POINTS = 8
    MEASUREMENT_TOO_FAR = 9
    MOVED_AS_A_WHOLE = 10
    MISFIT_ABOVE_NOISE = 11
    NAVIGATION_OFFSET = 12
    OFFSET_NOT_TOLD = 13
    TOO_FEW_BONE_POINTS = 14
    BONE_MISFIT = 15
    OK_IF_NAVIGATION_IS_RIGHT = 16

    @property
    def remedy(self) -> str:
        """One line: what happened and what to do."""
        return _REMEDY[self]

    def remedy_for(self, command: str) -> str:
        """Return the remedy as a command says it: with options that it has.

        Parameters
        ----------
        command : str
            "predict" or "register".
        """
        text = self.remedy
        if command == "register":
            text = _REMEDY_OF_REGISTRATION.get(self, text)
        return ARGUMENT.sub(lambda name: "--" + name[0].replace("_", "-"), text)

    @property
    def usable(self) -> bool:
        """Whether the displacement may be used with its error estimate as it is."""
        return self in (
            PredictionStatus.OK,
            PredictionStatus.OK_IF_NAVIGATION_IS_RIGHT,
            PredictionStatus.REPAIRED,
            PredictionStatus.SOLVED,
        )

    def __str__(self) -> str:
        return self.name.lower().replace("_", " ")


_REMEDY = {
    PredictionStatus.OK: "the prediction can be used with its error estimate",
    PredictionStatus.OK_IF_NAVIGATION_IS_RIGHT: (
        "it can be used with its error estimate once you have checked the navigation, "
        "or points of the bone (--bone) known to be in RAS have: one that is off into "
        "the brain looks like a brain that sank"
    ),
    PredictionStatus.REPAIRED: (
        "the estimate was above the tolerance, or promises nothing for this load, so "
        "the prediction was taken to equilibrium"
    ),
    PredictionStatus.SOLVED: (
        "the load was solved by finite elements from rest, no prediction being near "
        "enough"
    ),
    PredictionStatus.OUTSIDE_TRAINED_RANGE: (
        "the load lies outside the trained range, where the error estimate promises "
        "nothing: give tolerance_mm to have it solved"
    ),
    PredictionStatus.TOLERANCE_NOT_MET: (
        "the solve ended before it reached equilibrium: lower the force or refine the "
        "mesh under it"
    ),
    PredictionStatus.NO_ERROR_ESTIMATE: (
        "nothing says how large the error is: take the physical estimate, or train the "
        "run again with held-out load paths to calibrate it"
    ),
    PredictionStatus.ERROR_TOO_LARGE: (
        "the error may be too large beside the displacement: give tolerance_mm to have "
        "it repaired"
    ),
    PredictionStatus.IMPLAUSIBLE_DISPLACEMENT: (
        "no brain moves like that: check units, axes and the size of what was given"
    ),
    PredictionStatus.TOO_FEW_POINTS: (
        "the measured points are too few or too close together to tell how a brain "
        "moved: measure more of them, spread over the exposed surface"
    ),
    PredictionStatus.MEASUREMENT_TOO_FAR: (
        "what was measured does not lie where the brain's surface does: check "
        "coordinates, units (mm), which end is before, and the tracker's registration"
    ),
    PredictionStatus.MOVED_AS_A_WHOLE: (
        "everything measured moved alike, as it does when the tracker has moved and "
        "not the brain: check the tracker's reference"
    ),
    PredictionStatus.MISFIT_ABOVE_NOISE: (
        "what was measured does not fit this brain to within the stated noise: check "
        "for swapped or bad points, the mesh, and noise_mm"
    ),
    PredictionStatus.NAVIGATION_OFFSET: (
        "the navigation seems to be off by a rigid motion: give --bone, points of the "
        "bone that tell it, or --rigid-offset to have it corrected as it seems"
    ),
    PredictionStatus.OFFSET_NOT_TOLD: (
        "the brain hardly sank where it was measured: either it swells, or the "
        "navigation is off outward and hides that it sank; measure the whole surface, "
        "or give points of the bone (--bone)"
    ),
    PredictionStatus.TOO_FEW_BONE_POINTS: (
        "the bone points are too few or all in a line, so that the navigation may be "
        "turned about it: give three or more, spread around the craniotomy"
    ),
    PredictionStatus.BONE_MISFIT: (
        "the bone points do not agree on one offset of the navigation, or are none of "
        "bone: check for swapped or bad ones, and --bone-noise-mm; measure them again"
    ),
}

_REMEDY_OF_REGISTRATION = {
    PredictionStatus.TOLERANCE_NOT_MET: (
        "the search for equilibrium ended early: check points, --materials and --skull"
    ),
    PredictionStatus.NO_ERROR_ESTIMATE: (
        "nothing says how large the error is: measure more points, spread over the "
        "exposed surface"
    ),
    PredictionStatus.ERROR_TOO_LARGE: (
        "the error may be too large beside the displacement: measure more points, "
        "spread over the exposed surface, or landmarks inside the brain"
    ),
}

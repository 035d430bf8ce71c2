"""What a test machine measured: stress over stretch, or over the amount of shear."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.mechanics.materials.homogeneous import shear_stress, uniaxial_stress
from physgnn.mechanics.materials.table import Material

TENSION, COMPRESSION, SHEAR = "tension", "compression", "shear"
KINDS: Mapping[str, Callable[[Material, FloatArray], FloatArray]] = {
    TENSION: uniaxial_stress,
    COMPRESSION: uniaxial_stress,
    SHEAR: shear_stress,
}
"""Kind of test → stress of a law in it."""
MIN_POINTS = 3  # of a curve, the rest state not counted
LARGEST_STRETCH = 10.0  # and its inverse the smallest, and the largest amount of shear
STRESS_PA = (1e-6, 1e9)  # the largest of a curve lies between, in any soft tissue


@dataclass(frozen=True, eq=False)
class StressCurve:
    """One loading branch, from the rest state on.

    Parameters
    ----------
    kind : str
        A key of `KINDS`.
    amount : (n,) array
        Stretch λ (1 at rest) of tension and compression; amount of shear γ (0 at rest).
    stress_pa : (n,) array
        Nominal stress, Pa: force over area at rest. Negative in compression.

    Raises
    ------
    InputError
        If a number is not finite or not of soft tissue, a stretch is not positive or
        on the wrong side of rest, the load does not grow from point to point, the
        stress has the wrong sign on the whole, or fewer than three points are left
        beside rest.
    """

    kind: str
    amount: FloatArray
    stress_pa: FloatArray

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(
                f"kind must be one of {', '.join(KINDS)} (got '{self.kind}')"
            )
        for name in ("amount", "stress_pa"):
            values = np.array(getattr(self, name), dtype=np.float64).ravel()
            object.__setattr__(self, name, values)
            if not np.isfinite(values).all():
                raise InputError(f"{self.kind}: every number must be finite (got NaN)")
        if len(self.amount) != len(self.stress_pa):
            raise InputError(
                f"{self.kind}: every stretch needs its stress "
                f"(got {len(self.amount)} and {len(self.stress_pa)})"
            )
        self._check_amount()
        if np.count_nonzero(self.strain) < MIN_POINTS:
            raise InputError(
                f"{self.kind}: needs {MIN_POINTS} points or more beside the rest state "
                f"(got {np.count_nonzero(self.strain)})"
            )
        largest = np.abs(self.stress_pa).max()
        if not STRESS_PA[0] < largest < STRESS_PA[1]:
            raise InputError(
                f"{self.kind}: the largest stress must be in {STRESS_PA[0]:g}…"
                f"{STRESS_PA[1]:g} Pa (got {largest:g} Pa): name its unit, kPa or Pa"
            )
        if not self.stress_pa @ self.strain > 0:
            raise InputError(
                f"{self.kind}: the stress has the wrong sign: it is positive in "
                "tension and shear, negative in compression"
            )

    def _check_amount(self) -> None:
        """Raise InputError unless the load grows from the rest state."""
        if self.kind != SHEAR and not (self.amount > 0).all():
            raise InputError(
                f"{self.kind}: stretch must be > 0, 1 at rest (got {self.amount.min()})"
            )
        out_of_reach = self.amount > LARGEST_STRETCH
        if self.kind != SHEAR:
            out_of_reach |= self.amount < 1 / LARGEST_STRETCH
        if out_of_reach.any():
            raise InputError(
                f"{self.kind}: got {self.amount[out_of_reach][0]:g}, and no test goes "
                f"beyond a factor of {LARGEST_STRETCH:g}: give stretch, not percent"
            )
        growing = -self.strain if self.kind == COMPRESSION else self.strain
        if (growing < 0).any():
            wanted = {TENSION: "stretch ≥ 1", COMPRESSION: "stretch ≤ 1"}
            wrong = self.amount[growing < 0][0]
            raise InputError(
                f"{self.kind} takes {wanted.get(self.kind, 'an amount of shear ≥ 0')} "
                f"(got {wrong:g})"
            )
        back = np.flatnonzero(np.diff(growing) <= 0)
        if len(back):
            first, second = self.amount[back[0] : back[0] + 2]
            raise InputError(
                f"{self.kind}: the load must grow from point to point (got {second:g} "
                f"after {first:g}): give one loading branch"
            )

    @property
    def strain(self) -> FloatArray:
        """Amount less its value at rest."""
        strain: FloatArray = self.amount - (0.0 if self.kind == SHEAR else 1.0)
        return strain

    def stress_of(self, material: Material) -> FloatArray:
        """Return the nominal stress that a law gives at the same points, Pa."""
        return KINDS[self.kind](material, self.amount)

    def relative_error(self, material: Material) -> float:
        """RMS difference of a law's stress from the curve, over the curve's RMS."""
        difference = self.stress_of(material) - self.stress_pa
        size = np.linalg.norm(self.stress_pa)
        return float(np.linalg.norm(difference) / size)

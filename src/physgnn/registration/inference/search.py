"""The descent from the rest state to the most probable displacement.

About u, equilibrium is u + K(u)⁻¹ (B w − f_int(u)), linear in w, so that the best w is
that of a Gaussian regression, and the new u follows (Gauss–Newton on both together).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.prediction.measured_evidence import RigidOffset
from physgnn.registration.inference.bounds import Alternative
from physgnn.registration.inference.heavy_tails import reweighted, robust_start
from physgnn.registration.inference.rigid_offset import (
    OffsetPrior,
    compared,
    offset_of,
)
from physgnn.registration.inference.rows import (
    MeasuredRows,
    Modes,
    rigid_columns,
    rows_of,
)
from physgnn.registration.load_families import LoadModes
from physgnn.registration.measurements.observation import Measurement
from physgnn.registration.tangent_response import Fields

MAX_STEPS = 20
LONGEST_STEP_MM = 5.0  # longer ones leave the range where linear elasticity holds
MAX_HALVINGS = 6
STEP_TOLERANCE_MM = 0.01  # far below what a tracked pointer measures
# After so many steps a measured surface keeps its matching: points that change from
# face to face would never come to rest. A number, not a length: where a length
# decides, a change of 1e-6 mm in what was measured can be a change of a step.
MATCHED_STEPS = 8
WEIGHTINGS = 3  # a step


@dataclass(frozen=True, eq=False)
class Reached:
    """Where a search ended; its tangent is the one that was factorised last.

    Attributes
    ----------
    displacement : (n_points, 3) array
        u, mm.
    coefficients : (r,) array
        Those that go with it.
    response : (r, n_points, 3) array
        What each load mode does by that tangent, mm.
    """

    displacement: FloatArray
    coefficients: FloatArray
    response: Fields


Tangent = Callable[[FloatArray, FloatArray], tuple[Fields, FloatArray] | None]


class Search:
    """One descent.

    Parameters
    ----------
    tangent : callable
        From a displacement and the coefficients that go with it to the responses of
        all modes and the step backward.
    modes : LoadModes
        What may push the body.
    measured : sequence of Measurement
        Everything measured.
    noises : sequence of float
        Of each, mm.
    offset : OffsetPrior, optional
        Correct a rigid offset of the navigation, of which this is known.
    """

    def __init__(
        self,
        tangent: Tangent,
        modes: LoadModes,
        measured: Sequence[Measurement],
        noises: Sequence[float],
        *,
        offset: OffsetPrior | None = None,
    ) -> None:
        self._tangent, self._modes = tangent, modes
        self._measured, self._noises = measured, noises
        self._offset = offset
        self.u = np.zeros(modes.forces.shape[1:])
        self.w_at_u = np.zeros(len(modes.family))
        self.response: Fields = modes.response
        self._backward = np.zeros_like(self.u)
        self._seen = [one.observe(self.u) for one in measured]
        known = np.empty(0) if offset is None else offset.variances
        self._about = Modes(modes.family, known, min(noises), modes.most)
        self._prior, self.fit = robust_start(self.rows(), self._about)

    @property
    def w(self) -> FloatArray:
        """The coefficients that go with `u` when the search has ended."""
        return self.fit.posterior.mean[: len(self._modes.family)]

    @property
    def reached(self) -> Reached:
        """Where the search is."""
        return Reached(self.u, self.w_at_u, self.response)

    def rows(self) -> MeasuredRows:
        """Return everything measured, linearised about `u`."""
        rows = rows_of(self._seen, self._noises, self.response, self._backward)
        if self._offset is None:
            return rows
        columns, _ = rigid_columns(self._seen, self._measured)
        return rows.with_columns(columns @ self._offset.axes)

    def linear_step(self) -> bool:
        """Take the displacement of linear elasticity."""
        self.u = self._step()
        return True

    def descend(self) -> bool:
        """Step until steps are short; False if that was not reached."""
        for count in range(MAX_STEPS):
            step = self._step()
            length = float(np.linalg.norm(step, axis=1).max())
            part = min(1.0, LONGEST_STEP_MM / max(length, 1e-12))
            if not self._advance(step, part, matches=count < MATCHED_STEPS):
                return False
            if length < STEP_TOLERANCE_MM:
                return True
        return False

    def offset(self) -> tuple[RigidOffset, list[Alternative]]:
        """Return the rigid offset that the data speak for, about the last state.

        With it come the posteriors that the error is of: that of the search if an
        offset is corrected, otherwise one with each size of an offset and one without.
        """
        columns, centre = rigid_columns(self._seen, self._measured)
        rows = rows_of(self._seen, self._noises, self.response, self._backward)
        rows = rows.with_columns(columns)
        found = compared(rows, self._about, self.fit.weights)
        n = len(self._about.family)
        without = found.fits[0].posterior.mean
        change = combined(self.response, found.likely.posterior.mean[:n] - without)
        own = self.fit.posterior
        offset = offset_of(
            found.likely.posterior if self._offset is None else own,
            centre,
            found,
            change_mm=float(np.linalg.norm(change, axis=1).max()),
            corrected=self._offset is not None,
        )
        alone = self.alone()
        if self._offset is not None:
            return offset, alone
        others = zip(found.probabilities[1:], found.fits[1:], strict=True)
        return offset, [
            replace(alone[0], probability=float(found.probabilities[0])),
            *(
                Alternative(
                    float(probability),
                    fit.posterior.mean[:n] - without,
                    fit.posterior.covariance[:n, :n],
                )
                for probability, fit in others
            ),
        ]

    def alone(self) -> list[Alternative]:
        """Return the posterior of the search as the only one the error may be of."""
        n = len(self._about.family)
        return [Alternative(1.0, np.zeros(n), self.fit.posterior.covariance[:n, :n])]

    def _step(self) -> FloatArray:
        return self._backward + combined(self.response, self.w)

    def _advance(self, step: FloatArray, part: float, *, matches: bool) -> bool:
        """Go a part of a step, a half, a quarter … of it, to where the body is stable.

        The coefficients go as far.
        """
        for halvings in range(MAX_HALVINGS):
            gone = part / 2**halvings
            u = self.u + gone * step
            w = self.w_at_u + gone * (self.w - self.w_at_u)
            found = self._tangent(u, w)
            if found is None:
                continue
            self._seen = (
                [one.observe(u) for one in self._measured]
                if matches
                else [one.after(u - self.u) for one in self._seen]
            )
            self.u, self.w_at_u = u, w
            self.response, self._backward = found
            self.fit = reweighted(
                self.rows(), self._prior, self.fit.weights, WEIGHTINGS
            )
            return True
        return False


def combined(fields: Fields, w: FloatArray) -> FloatArray:
    """Return the sum of fields, each times its coefficient."""
    return np.tensordot(w, fields, 1).astype(np.float64)

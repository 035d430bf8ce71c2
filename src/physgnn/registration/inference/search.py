"""The descent from a state to the most probable displacement.

About u, equilibrium is u + K(u)⁻¹ (B w − f_int(u)), linear in w, so that the best w is
that of a Gaussian regression, and the new u follows (Gauss–Newton on both together).

A step with a new tangent costs a factorisation and one back-substitution for each load
mode; without one it costs a single back-substitution. So the tangent is kept while
steps get shorter (the chord method), renewed once near the end, whose linearisation the
error bounds are of, and whenever steps don't get shorter.

The prior and what is an outlier follow from the measurement about the rest state,
wherever the search begins: a state of a series has the result that it would have alone.
"""

from collections.abc import Iterator, Sequence
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
    unknown_of,
)
from physgnn.registration.inference.rows import (
    MeasuredRows,
    Modes,
    rigid_columns,
    rows_of,
)
from physgnn.registration.load_families import LoadModes
from physgnn.registration.measurements.observation import Measurement
from physgnn.registration.mode_response import ModeResponse
from physgnn.registration.tangent_response import Fields

MAX_STEPS = 40
LONGEST_STEP_MM = 5.0  # longer ones leave the range where linear elasticity holds
MAX_HALVINGS = 6
STEP_TOLERANCE_MM = 0.01  # far below what a tracked pointer measures
NEAR_MM = 0.5  # nearer than this the tangent is that of the end, and is renewed once
SHORTER = 0.6  # a step without a new tangent is to be so much shorter than the last
# After so many steps a measured surface keeps its matching: points that change from
# face to face would never come to rest. A number, not a length: where a length
# decides, a change of 1e-6 mm in what was measured can be a change of a step.
MATCHED_STEPS = 12
# After so many the coefficients are kept, too, and equilibrium alone is sought: where a
# thin sheet is about to buckle, each new tangent would ask for others.
FITTED_STEPS = 20
WEIGHTINGS = 3  # a step
TOO_FAR = 0.5  # of what pushed a body forward may push it back after a step


@dataclass(frozen=True, eq=False)
class Reached:
    """A state whose tangent, or one near it, was factorised last.

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


class Search:
    """One descent.

    Parameters
    ----------
    respond : ModeResponse
        Factorised about `start`, or near it.
    modes : LoadModes
        What may push the body.
    measured : sequence of Measurement
        Everything measured.
    noises : sequence of float
        Of each, mm.
    start : Reached
        Where it begins: the rest state, or another that is stable.
    offset : OffsetPrior, optional
        Correct a rigid offset of the navigation, of which this is known.
    """

    def __init__(
        self,
        respond: ModeResponse,
        modes: LoadModes,
        measured: Sequence[Measurement],
        noises: Sequence[float],
        *,
        start: Reached,
        offset: OffsetPrior | None = None,
    ) -> None:
        self._respond, self._modes = respond, modes
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
        self._kept: FloatArray | None = None
        self._begins = self._placed_at(start)

    def _placed_at(self, start: Reached) -> bool:
        """Go where the search begins; False if a cell is inverted there."""
        if not start.displacement.any():
            return True
        self.response = start.response
        return self._moved_to(start.displacement, start.coefficients, matches=True)

    @property
    def w(self) -> FloatArray:
        """The coefficients that go with `u` when the search has ended."""
        if self._kept is not None:
            return self._kept
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
        if not self._begins:
            return False
        before, renewed = np.inf, False
        for count in range(MAX_STEPS):
            step = self._step()
            length = float(np.linalg.norm(step, axis=1).max())
            part = min(1.0, LONGEST_STEP_MM / max(length, 1e-12))
            ends = renewed and length < STEP_TOLERANCE_MM
            matches = count < MATCHED_STEPS
            if count == FITTED_STEPS:
                self._kept = self.w
            kept = length < SHORTER * before and (renewed or length > NEAR_MM)
            if (ends or kept) and self._along(step, part, matches=matches):
                before = length
            elif self._advance(step, part, matches=matches):
                before, renewed = np.inf, True
            else:
                return False
            if ends:
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
            unknown_mm=unknown_of(rows, self._prior[:n], self.fit.weights),
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

        The coefficients go as far, and the tangent is renewed.
        """
        for u, w in self._shorter_and_shorter(step, part):
            found = self._respond(u, w)
            if found is None:
                continue
            self.response, backward = found
            self._arrive(u, w, backward, matches=matches)
            return True
        return False

    def _along(self, step: FloatArray, part: float, *, matches: bool) -> bool:
        """Go a part of a step, a half, a quarter … of it, with the tangent kept."""
        return any(
            self._moved_to(u, w, matches=matches)
            for u, w in self._shorter_and_shorter(step, part)
        )

    def _shorter_and_shorter(
        self, step: FloatArray, part: float
    ) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Yield a part of a step, a half, a quarter … of it, and its coefficients.

        Parts that go too far are left out: those at whose end the body is pushed back
        by more than half of what pushed it forward.
        """
        change = self.w - self.w_at_u
        forward = self._pushed(self.u, step)
        for gone in part / 2.0 ** np.arange(MAX_HALVINGS):
            u = self.u + gone * step
            if self._pushed(u, step) >= -TOO_FAR * abs(forward):
                yield u, self.w_at_u + gone * change

    def _pushed(self, u: FloatArray, step: FloatArray) -> float:
        """Return how much the loads push the body along a step, N mm.

        It is −∞ where a cell is inverted.
        """
        unbalanced = self._respond.unbalanced(u, self.w)
        return -np.inf if unbalanced is None else float((unbalanced * step).sum())

    def _moved_to(self, u: FloatArray, w: FloatArray, *, matches: bool) -> bool:
        """Go to a state with the tangent kept; False if a cell is inverted there."""
        backward = self._respond.backward(u, w, self.response)
        if backward is None:
            return False
        self._arrive(u, w, backward, matches=matches)
        return True

    def _arrive(
        self, u: FloatArray, w: FloatArray, backward: FloatArray, *, matches: bool
    ) -> None:
        """Take a state for the one that the search is at, and fit again."""
        self._seen = (
            [one.observe(u) for one in self._measured]
            if matches
            else [one.after(u - self.u) for one in self._seen]
        )
        self.u, self.w_at_u, self._backward = u, w, backward
        self.fit = reweighted(self.rows(), self._prior, self.fit.weights, WEIGHTINGS)


def combined(fields: Fields, w: FloatArray) -> FloatArray:
    """Return the sum of fields, each times its coefficient."""
    return np.tensordot(w, fields, 1).astype(np.float64)

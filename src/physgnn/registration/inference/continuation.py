"""The descent of one state after another, which begins where the last one ended.

The prior and what is an outlier follow from what was measured now, about the rest
state, as they do of a first state: so the result is that of this state alone. What the
state before gives is a place to begin, and the tangent there. It is kept while steps
get shorter (the chord method), renewed once near the end, and whenever steps don't get
shorter: a step without a new tangent costs a back-substitution where one with it costs
a factorisation and one back-substitution for each load mode.
"""

from collections.abc import Sequence

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.registration.inference.heavy_tails import reweighted
from physgnn.registration.inference.rigid_offset import OffsetPrior
from physgnn.registration.inference.search import (
    LONGEST_STEP_MM,
    MAX_HALVINGS,
    MAX_STEPS,
    STEP_TOLERANCE_MM,
    WEIGHTINGS,
    Reached,
    Search,
)
from physgnn.registration.load_families import LoadModes
from physgnn.registration.measurements.observation import Measurement
from physgnn.registration.mode_response import ModeResponse

NEAR_MM = 0.5  # nearer than this the tangent is that of the end, and is renewed once
SHORTER = 0.6  # a step without a new tangent is to be so much shorter than the last
MATCHED_STEPS = 12  # as of a first state, whose steps are longer


class Continuation(Search):
    """A descent from a state near by.

    Parameters
    ----------
    tangent : ModeResponse
        Factorised about `start`, or near it.
    modes, measured, noises, offset
        As of `Search`.
    start : Reached
        The state before.
    """

    def __init__(
        self,
        tangent: ModeResponse,
        modes: LoadModes,
        measured: Sequence[Measurement],
        noises: Sequence[float],
        *,
        start: Reached,
        offset: OffsetPrior | None = None,
    ) -> None:
        super().__init__(tangent, modes, measured, noises, offset=offset)
        self._chord = tangent.backward
        self.response = start.response
        self._begins = self._moved_to(
            start.displacement, start.coefficients, matches=True
        )

    def descend(self) -> bool:
        """Step until steps are short; False if that was not reached."""
        if not self._begins:
            return False
        before, renewed = np.inf, False
        for count in range(2 * MAX_STEPS):
            step = self._step()
            length = float(np.linalg.norm(step, axis=1).max())
            part = min(1.0, LONGEST_STEP_MM / max(length, 1e-12))
            ends = renewed and length < STEP_TOLERANCE_MM
            matches = count < MATCHED_STEPS
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

    def _along(self, step: FloatArray, part: float, *, matches: bool) -> bool:
        """Go a part of a step, a half, a quarter … of it, with the tangent kept."""
        change = self.w - self.w_at_u
        return any(
            self._moved_to(
                self.u + gone * step, self.w_at_u + gone * change, matches=matches
            )
            for gone in part / 2.0 ** np.arange(MAX_HALVINGS)
        )

    def _moved_to(self, u: FloatArray, w: FloatArray, *, matches: bool) -> bool:
        """Go to a state with the tangent kept; False if a cell is inverted there."""
        backward = self._chord(u, w, self.response)
        if backward is None:
            return False
        self._seen = (
            [one.observe(u) for one in self._measured]
            if matches
            else [one.after(u - self.u) for one in self._seen]
        )
        self.u, self.w_at_u, self._backward = u, w, backward
        self.fit = reweighted(self.rows(), self._prior, self.fit.weights, WEIGHTINGS)
        return True

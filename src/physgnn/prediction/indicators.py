"""Cheap signs of how wrong a prediction may be, known before the truth is.

An indicator turns a prediction into a field (n_points, 3) in mm; the mean and the
largest length of it, times a calibrated factor, bound the mean and the largest error.
To add one: write a function from a body (and, for those who need it, a quick way to
its linear answer) to an indicator, and a row in INDICATORS.
"""

from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.continued import continued_force
from physgnn.mechanics.element import DEFAULT_ELEMENT
from physgnn.mechanics.loads import LoadCase
from physgnn.mechanics.rest_state import RestState
from physgnn.prediction.linear import linear_answer
from physgnn.prediction.prediction import Answer

FloatArray = NDArray[np.float64]
Indicator = Callable[[LoadCase, FloatArray], FloatArray]


class MakeIndicator(Protocol):
    """From a body to an indicator; `linear` answers K₀⁻¹ f if that's to be had."""

    def __call__(self, body: Body, linear: Answer | None = None) -> Indicator:
        """Return the indicator."""


def displacement_indicator(body: Body, linear: Answer | None = None) -> Indicator:
    """Return û itself: the factor is then a bound on the relative error."""
    del body, linear
    return lambda _, displacement: displacement


def correction_indicator(body: Body, linear: Answer | None = None) -> Indicator:
    """Return û − K₀⁻¹ f: how much of the answer is not linear elasticity."""
    linear = linear or linear_answer(body)
    return lambda case, displacement: displacement - linear(case)


def residual_indicator(body: Body, linear: Answer | None = None) -> Indicator:
    """Return K₀⁻¹ (f − f_int(û)), what the force out of balance would do at rest.

    Cells may be inverted in û (`physgnn.mechanics.continued`).
    """
    del linear
    if body.element != DEFAULT_ELEMENT:  # stress is continued in lone cells only
        raise InputError(f"indicator residual knows {DEFAULT_ELEMENT} elements only")
    rest = RestState(body)

    def residual(case: LoadCase, displacement: FloatArray) -> FloatArray:
        force, _ = continued_force(body.elements, displacement)
        return rest.solve(case.on_points(body.mesh.n_points) - force)

    return residual


INDICATORS: Mapping[str, MakeIndicator] = {
    "displacement": displacement_indicator,
    "correction": correction_indicator,
    "residual": residual_indicator,
}

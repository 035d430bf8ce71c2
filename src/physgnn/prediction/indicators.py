"""Cheap signs of how wrong a prediction may be, known before the truth is.

An indicator turns a prediction into a field (n_points, 3) in mm; the mean and the
largest length of it, times a calibrated factor, bound the mean and the largest error.
To add one: write a function from a body to an indicator, and a row in INDICATORS.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from physgnn.learning.interface import Body
from physgnn.mechanics.continued import continued_force
from physgnn.mechanics.element import make_elements
from physgnn.mechanics.loads import LoadCase
from physgnn.mechanics.rest_state import RestState

FloatArray = NDArray[np.float64]
Indicator = Callable[[LoadCase, FloatArray], FloatArray]


def displacement_indicator(body: Body) -> Indicator:
    """Return û itself: the factor is then a bound on the relative error."""
    del body
    return lambda _, displacement: displacement


def correction_indicator(body: Body) -> Indicator:
    """Return û − K₀⁻¹ f: how much of the answer is not linear elasticity."""
    rest = RestState(body.mesh, body.materials, body.fixed)

    def correction(case: LoadCase, displacement: FloatArray) -> FloatArray:
        return displacement - rest.solve(case.on_points(body.mesh.n_points))

    return correction


def residual_indicator(body: Body) -> Indicator:
    """Return K₀⁻¹ (f − f_int(û)), what the force out of balance would do at rest.

    Cells may be inverted in û (`physgnn.mechanics.continued`).
    """
    rest = RestState(body.mesh, body.materials, body.fixed)
    elements = make_elements(body.mesh, body.materials)

    def residual(case: LoadCase, displacement: FloatArray) -> FloatArray:
        force, _ = continued_force(elements, displacement)
        return rest.solve(case.on_points(body.mesh.n_points) - force)

    return residual


INDICATORS: Mapping[str, Callable[[Body], Indicator]] = {
    "displacement": displacement_indicator,
    "correction": correction_indicator,
    "residual": residual_indicator,
}

"""Cheap signs of how wrong a prediction may be, known before the truth is.

An indicator turns a prediction into a field (n_points, 3) in mm; the mean and the
largest length of it, times a calibrated factor, bound the mean and the largest error.
To add one: write a function from the surrogate that predicts to an indicator, and a row
in INDICATORS.
"""

from collections.abc import Callable, Mapping

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics.elements.inverted import extrapolated_force
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadCase

Indicator = Callable[[LoadCase, FloatArray], FloatArray]


def displacement_indicator(surrogate: Surrogate) -> Indicator:
    """Return û itself: the factor is then a bound on the relative error."""
    del surrogate
    return lambda _, displacement: displacement


def correction_indicator(surrogate: Surrogate) -> Indicator:
    """Return û − K₀⁻¹ f: how much of the displacement is not linear elasticity."""
    return lambda case, displacement: displacement - surrogate.linear(case)


def residual_indicator(surrogate: Surrogate) -> Indicator:
    """Return K₀⁻¹ (f − f_int(û)), what the force out of balance would do at rest.

    Cells may be inverted in û (`physgnn.mechanics.elements.inverted`).
    """
    body = surrogate.body
    if body.element != DEFAULT_ELEMENT:  # stress is extrapolated in lone cells only
        raise InputError(f"indicator residual knows {DEFAULT_ELEMENT} elements only")
    rest = RestState(body)

    def residual(case: LoadCase, displacement: FloatArray) -> FloatArray:
        force, _ = extrapolated_force(body.elements, displacement)
        return rest.solve(case.on_points(body.mesh.n_points) - force)

    return residual


INDICATORS: Mapping[str, Callable[[Surrogate], Indicator]] = {
    "displacement": displacement_indicator,
    "correction": correction_indicator,
    "residual": residual_indicator,
}

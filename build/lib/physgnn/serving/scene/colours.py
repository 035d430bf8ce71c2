"""The scalars a surface can be coloured by: one row each.

The rows decide what a browser may ask for (`messages`), and travel with the scene's
first frame (`predictions`), from which the page builds its menu and its legends. To
add a scalar, write a function and its row; docs/howto/add_colour.md has a template.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.geometry.tetmesh import TetMesh, signed_volumes
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.prediction import Prediction
from physgnn.serving.scene.viewed import FINITE_ELEMENTS, Viewed

TISSUE = "#d4cac0"  # where a map starts, so that what does not move stays calm


@dataclass(frozen=True, eq=False)
class SolvedLoad:
    """A load and the displacement found for it.

    Attributes
    ----------
    by : str
        Who found it: a key of `Viewed.predictors`, or `FINITE_ELEMENTS`.
    case : LoadCase or None
        The load; a registration has none.
    prediction : Prediction
        The displacement, its error bound and status.
    deviation_mm : (n_points,) array or None
        Standard deviation of each point's displacement, of a registration.
    """

    by: str
    case: LoadCase | None
    prediction: Prediction
    deviation_mm: FloatArray | None = None


Measure = Callable[[Viewed, SolvedLoad], FloatArray | None]


@dataclass(frozen=True)
class ColourField:
    """One scalar to colour by.

    Attributes
    ----------
    label : str
        In the page's menu.
    title : str
        Above the legend, with the unit.
    stops : tuple of str
        Colours from the lowest to the highest value, ``#rrggbb``, evenly spaced.
    least : float
        The range shown reaches at least so far from `centre`, in the scalar's unit.
    measure : callable or None
        From what is viewed and a solved load to one value a mesh point, (n_points,),
        or None where the scalar isn't known. Without one the page takes the length of
        the displacement, which it has.
    centre : float
        The value at rest.
    diverging : bool
        Whether the range shown reaches below `centre` as well.
    calibrated : bool
        Whether only a calibrated network has it.
    registered : bool
        Whether only a registration has it.
    """

    label: str
    title: str
    stops: tuple[str, ...]
    least: float
    measure: Measure | None = None
    centre: float = 0.0
    diverging: bool = False
    calibrated: bool = False
    registered: bool = False

    def describe(self, viewed: Viewed) -> dict[str, Any]:
        """Return the row as JSON can hold it, for the page."""
        return {
            "label": self.label,
            "title": self.title,
            "stops": list(self.stops),
            "least": self.least,
            "centre": self.centre,
            "diverging": self.diverging,
            "sent": self.measure is not None,
            "available": viewed.calibration is not None or not self.calibrated,
        }


def error_bound(viewed: Viewed, solved: SolvedLoad) -> FloatArray | None:
    """Return how the bound on the error is spread, mm; None where there is none.

    Of a calibrated network it is the indicator times the factor of the largest error:
    its maximum is the bound, its shape says where the displacement is least linear, and
    no more. Finite elements keep one bound everywhere.
    """
    displacement = solved.prediction.displacement
    if solved.by == FINITE_ELEMENTS:
        within = solved.prediction.error_estimate_mm
        return None if within is None else np.full(len(displacement), within.max_mm)
    if viewed.calibration is None or viewed.indicator is None or solved.by != "network":
        return None
    assert solved.case is not None
    length = np.linalg.norm(viewed.indicator(solved.case, displacement), axis=1)
    bound: FloatArray = viewed.calibration.max_factor * length
    return bound


def deviation(_: Viewed, solved: SolvedLoad) -> FloatArray | None:
    """Return the standard deviation of each point's displacement, mm."""
    return solved.deviation_mm


def volume_ratio(viewed: Viewed, solved: SolvedLoad) -> FloatArray:
    """Return det F at the points: deformed over rest volume of the cells around."""
    mesh = viewed.body.mesh
    deformed = signed_volumes(mesh.points + solved.prediction.displacement, mesh.cells)
    return _around(mesh, deformed) / _around(mesh, mesh.cell_volumes)


FIELDS: dict[str, ColourField] = {
    "displacement": ColourField(
        label="Displacement",
        title="Displacement, mm",
        stops=(TISSUE, "#f0c878", "#ea8a3c", "#cf4446", "#7c2250"),
        least=1.0,
    ),
    "error": ColourField(
        label="Error",
        title="Estimated error, mm",
        stops=(TISSUE, "#a9cbd6", "#5f9dcb", "#3f62b0", "#2c2a6e"),
        least=0.01,
        measure=error_bound,
        calibrated=True,
    ),
    "volume": ColourField(
        label="det F",
        title="det F: volume ratio",
        stops=("#2a5fa8", "#86b2d8", TISSUE, "#e39b76", "#a8323a"),
        least=0.02,
        measure=volume_ratio,
        centre=1.0,
        diverging=True,
    ),
    "deviation": ColourField(
        label="Deviation",
        title="Standard deviation, mm",
        stops=("#3f8f7f", "#8fc3a0", "#f0d58c", "#e58a4a", "#a8323a"),
        least=0.5,
        measure=deviation,
        registered=True,
    ),
}


def _around(mesh: TetMesh, of_cells: FloatArray) -> FloatArray:
    shared = np.repeat(of_cells, 4)
    total = np.bincount(mesh.cells.ravel(), shared, mesh.n_points).astype(np.float64)
    return np.where(total == 0.0, 1.0, total)

"""The scalars a surface can be coloured by, beside the displacement itself.

To add one: write a function and a row in FIELDS, and a row in static/colours.js.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from physgnn.geometry import TetMesh
from physgnn.mechanics.loads import LoadCase
from physgnn.serving.viewed import Viewed

FloatArray = NDArray[np.float64]
Field = Callable[[Viewed, str, LoadCase, FloatArray], FloatArray | None]


def error_bound(
    viewed: Viewed, answer: str, case: LoadCase, displacement: FloatArray
) -> FloatArray | None:
    """Return how the bound on the error is spread, mm; None where there is none.

    The calibrated indicator times the factor of the largest error: its maximum is the
    bound, its shape says where the answer is least linear, and no more.
    """
    if viewed.calibration is None or viewed.indicator is None or answer != "network":
        return None
    length = np.linalg.norm(viewed.indicator(case, displacement), axis=1)
    bound: FloatArray = viewed.calibration.max_factor * length
    return bound


def volume_ratio(
    viewed: Viewed, answer: str, case: LoadCase, displacement: FloatArray
) -> FloatArray:
    """Return det F at the points: deformed over rest volume of the cells around."""
    del answer, case
    mesh = viewed.body.mesh
    deformed = _volumes(mesh, mesh.points + displacement)
    return _around(mesh, deformed) / _around(mesh, mesh.cell_volumes)


FIELDS: Mapping[str, Field] = {"error": error_bound, "volume": volume_ratio}


def _volumes(mesh: TetMesh, points: FloatArray) -> FloatArray:
    a, b, c, d = (points[mesh.cells[:, i]] for i in range(4))
    volumes: FloatArray = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6.0
    return volumes


def _around(mesh: TetMesh, of_cells: FloatArray) -> FloatArray:
    shared = np.repeat(of_cells, 4)
    total = np.bincount(mesh.cells.ravel(), shared, mesh.n_points).astype(np.float64)
    return np.where(total == 0.0, 1.0, total)

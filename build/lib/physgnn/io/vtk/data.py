"""What a VTK file holds, as arrays that have been checked."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.io.untrusted.numbers import real_numbers, whole_numbers

Array = np.ndarray[Any, Any]


@dataclass(frozen=True, eq=False)
class VtkData:
    """Points, cells and named arrays of an unstructured grid or of polygons.

    Parameters
    ----------
    points : (n_points, 3) array
        Coordinates as the file has them.
    connectivity : (n_corners,) integer array
        The points of every cell, one cell after the other.
    offsets : (n_cells + 1,) integer array
        Where each cell begins in `connectivity`, and the end of the last.
    cell_types : (n_cells,) integer array
        VTK's numbers of the kinds of cells.
    point_data, cell_data, field_data : mapping of str to array
        Named arrays.

    Raises
    ------
    InputError
        If cells and offsets do not fit, a cell names a point that is not there, or an
        array has not one row a point or cell.
    """

    points: FloatArray
    connectivity: IntArray
    offsets: IntArray
    cell_types: IntArray
    point_data: Mapping[str, Array] = field(default_factory=dict)
    cell_data: Mapping[str, Array] = field(default_factory=dict)
    field_data: Mapping[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        points = real_numbers(self.points, "points")
        if points.ndim != 2 or points.shape[1] != 3:
            raise InputError(f"points must have three coordinates (got {points.shape})")
        object.__setattr__(self, "points", points)
        for name in ("connectivity", "offsets", "cell_types"):
            values = whole_numbers(getattr(self, name), name).ravel()
            object.__setattr__(self, name, values)
        self._check_cells()
        for kind, n in (("point", self.n_points), ("cell", self.n_cells)):
            for name, values in getattr(self, f"{kind}_data").items():
                if len(values) != n:
                    raise InputError(
                        f"{kind} array '{name}' must have {n} rows (got {len(values)})"
                    )

    def _check_cells(self) -> None:
        offsets, corners = self.offsets, self.connectivity
        if len(offsets) != self.n_cells + 1:
            raise InputError(
                f"cells must have a type each (got {self.n_cells} types for "
                f"{len(offsets) - 1} cells)"
            )
        whole = len(offsets) > 0 and offsets[0] == 0 and offsets[-1] == len(corners)
        if not whole or (np.diff(offsets) < 0).any():
            raise InputError("the offsets of its cells do not fit their corners")
        if len(corners) and (corners.min() < 0 or corners.max() >= self.n_points):
            raise InputError(
                f"a cell names a point that is not there (points are 0…"
                f"{self.n_points - 1}, got {corners.min()}…{corners.max()})"
            )

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.points)

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return len(self.cell_types)

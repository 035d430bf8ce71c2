"""Tissue that a resection took out, kept beside the displacement of what is left.

The mesh of a displacement holds what is left, so that a place in the cavity is in none
of its cells. What was there at rest stands in the file's field data: its own points and
cells. Images show no tissue there.
"""

from pathlib import Path

import numpy as np
import pyvista as pv

from physgnn.errors import InputError
from physgnn.geometry.array_checks import checked_indices, checked_points
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.numbers import real_numbers, whole_numbers
from physgnn.io.vtk.reader import read_vtk

POINTS, CELLS = "removed_points", "removed_cells"


def add_removed(data: pv.DataSet, removed: TetMesh | None) -> None:
    """Put removed tissue into field data; None leaves it out."""
    if removed is not None:
        data.field_data[POINTS] = removed.points
        data.field_data[CELLS] = removed.cells


def read_removed(path: str | Path) -> TetMesh | None:
    """Return the tissue that was removed, at rest; None if none was.

    Parameters
    ----------
    path : path
        VTU, as `physgnn register --remove` writes it.

    Raises
    ------
    InputError
        If the file cannot be read, or its removed cells name points it has not.
    """
    arrays = read_vtk(Path(path)).field_data
    if POINTS not in arrays or CELLS not in arrays:
        return None
    with reading(Path(path), "removed tissue"):
        points = checked_points(real_numbers(arrays[POINTS], POINTS), POINTS)
        cells = whole_numbers(arrays[CELLS], CELLS)
        if cells.ndim != 2 or cells.shape[1] != 4 or not len(cells):
            raise InputError(f"'{CELLS}' must be cells of four (got {cells.shape})")
        checked_indices(cells.ravel(), len(points), CELLS)
        return TetMesh(points, cells.astype(np.int32), np.ones(len(cells), np.int32))

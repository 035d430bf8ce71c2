"""What a file says of the error of each displacement.

``deviation_mm`` is the standard deviation, the root of the trace. ``covariance_mm2``
has six components a point: xx, yy, zz, xy, yz, xz, as VTK orders symmetric tensors.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.numbers import real_numbers
from physgnn.io.vtk.prediction_file import read_displacement
from physgnn.io.vtk.reader import read_vtk
from physgnn.progress import Log, no_log

DEVIATION, COVARIANCE = "deviation_mm", "covariance_mm2"
ROWS, COLUMNS = (0, 1, 2, 0, 1, 0), (0, 1, 2, 1, 2, 2)


@dataclass(frozen=True, eq=False)
class ErrorFields:
    """A displacement and how far to trust it.

    Attributes
    ----------
    mesh : TetMesh
        The rest state.
    displacement : (n_points, 3) array
        mm.
    deviation_mm : (n_points,) array
        Standard deviation of each point's displacement.
    covariance_mm2 : (n_points, 3, 3) array or None
        Of its error, where the file has it.
    """

    mesh: TetMesh
    displacement: FloatArray
    deviation_mm: FloatArray
    covariance_mm2: FloatArray | None


def packed(covariance: FloatArray) -> FloatArray:
    """Return covariances (n, 3, 3) as files hold them, (n, 6)."""
    return covariance[:, ROWS, COLUMNS]


def read_error_fields(path: str | Path, *, log: Log = no_log) -> ErrorFields:
    """Read what `physgnn register` writes.

    Parameters
    ----------
    path : path
        VTU.
    log : callable
        As of `read_displacement`.

    Raises
    ------
    InputError
        If it is no displacement, or says nothing of the error of each point.
    """
    mesh, u = read_displacement(path, log=log)
    arrays = read_vtk(Path(path)).point_data
    with reading(path, "errors of a displacement"):
        if DEVIATION not in arrays:
            raise InputError(
                f"needs a point array '{DEVIATION}', which 'physgnn register' writes "
                f"(it has: {', '.join(arrays)}). What 'predict' says of its error is a "
                "bound for the whole brain, with no probability at a point"
            )
        deviation = _checked(arrays[DEVIATION], DEVIATION, (mesh.n_points,))
        if (deviation < 0).any():
            raise InputError(f"'{DEVIATION}' must be ≥ 0 (got {deviation.min()})")
        if COVARIANCE not in arrays:
            return ErrorFields(mesh, u, deviation, None)
        six = _checked(arrays[COVARIANCE], COVARIANCE, (mesh.n_points, 6))
        covariance = np.empty((mesh.n_points, 3, 3))
        covariance[:, ROWS, COLUMNS] = covariance[:, COLUMNS, ROWS] = six
        return ErrorFields(mesh, u, deviation, covariance)


def _checked(values: FloatArray, name: str, shape: tuple[int, ...]) -> FloatArray:
    found = real_numbers(values, f"'{name}'")
    if found.shape != shape or not np.isfinite(found).all():
        raise InputError(f"'{name}' must be finite, {shape} (got {found.shape})")
    return found

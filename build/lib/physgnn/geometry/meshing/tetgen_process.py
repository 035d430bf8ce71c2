"""One TetGen run in a process of its own.

`run` starts this file as a script, which imports NumPy, tetgen and what it needs of
this package alone.
"""

import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.geometry.meshing.mesher_process import (
    INPUT,
    OUTPUT,
    Arrays,
    run_script,
)


def available() -> bool:
    """Whether the tetgen package is installed."""
    return find_spec("tetgen") is not None


def run(
    points: FloatArray,
    faces: NDArray[np.int32],
    switches: str,
    *,
    timeout_s: float = 600.0,
) -> tuple[FloatArray, NDArray[np.int32], NDArray[np.int32]]:
    """Mesh a piecewise linear complex.

    Returns
    -------
    points (n_points, 3), cells (n_cells, 4), attribute (n_cells,)
        The attribute is TetGen's number of the region a cell lies in.

    Raises
    ------
    RuntimeError
        If TetGen fails, faults or takes longer than `timeout_s`; the message is
        its last line.
    """
    arrays: Arrays = {"points": points, "faces": faces}
    made = run_script(__file__, arrays, switches, timeout_s=timeout_s)
    return (
        np.asarray(made["points"], dtype=np.float64),
        np.asarray(made["cells"], dtype=np.int32),
        np.asarray(made["attribute"], dtype=np.int32),
    )


def main(folder: str, switches: str) -> None:
    """Read the surface in a folder, mesh it, write the mesh beside it."""
    import tetgen

    with np.load(Path(folder) / INPUT, allow_pickle=False) as surface:
        mesher = tetgen.TetGen(surface["points"], surface["faces"])
    points, cells, attribute, _ = mesher.tetrahedralize(switches=switches)
    np.savez(
        Path(folder) / OUTPUT,
        points=points,
        cells=cells,
        attribute=attribute.reshape(-1).astype(np.int32),
    )


if __name__ == "__main__":
    main(*sys.argv[1:])

"""One run of fTetWild in a process of its own.

`run` starts this file as a script, which imports NumPy, pytetwild and what it needs of
this package alone, on one thread. Two runs on the same surfaces give meshes of the same
quality, but not the same points: fTetWild inserts the triangles in an order that it
draws from the system's random numbers, and pytetwild 0.4 has no argument for a seed.
"""

import sys
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


def run(
    points: FloatArray,
    faces: NDArray[np.int32],
    edge_mm: float,
    *,
    envelope: float,
    timeout_s: float = 1800.0,
) -> tuple[FloatArray, NDArray[np.int32]]:
    """Mesh what closed surfaces enclose, each kept as faces of cells.

    Parameters
    ----------
    points, faces : (n_points, 3), (n_faces, 3) arrays
        The surfaces.
    edge_mm : float
        Edge length aimed at.
    envelope : float
        How far the mesh's surfaces may lie from those given, over the diagonal of their
        bounding box.
    timeout_s : float
        After which it is stopped.

    Returns
    -------
    points (n_points, 3), cells (n_cells, 4)

    Raises
    ------
    RuntimeError
        If it fails, faults or takes longer; the message is its last line.
    """
    arrays: Arrays = {"points": points, "faces": faces}
    options = (f"{edge_mm:.6g}", f"{envelope:.6g}")
    made = run_script(__file__, arrays, *options, timeout_s=timeout_s)
    return (
        np.asarray(made["points"], dtype=np.float64),
        np.asarray(made["cells"], dtype=np.int32),
    )


def main(folder: str, edge_mm: str, envelope: str) -> None:
    """Read the surfaces in a folder, mesh them, write the mesh beside them."""
    from pytetwild.pytetwild import tetrahedralize

    with np.load(Path(folder) / INPUT, allow_pickle=False) as surface:
        points, cells = tetrahedralize(
            surface["points"],
            surface["faces"],
            edge_length_abs=float(edge_mm),
            epsilon=float(envelope),
            num_threads=1,
            vtk_ordering=True,
        )
    np.savez(Path(folder) / OUTPUT, points=points, cells=cells.astype(np.int32))


if __name__ == "__main__":
    main(*sys.argv[1:])

"""One TetGen run in a process of its own.

TetGen may abort or fault on input it cannot mesh, and writes to standard output;
neither may reach the caller. `run` starts this file as a script, which imports
NumPy and tetgen alone, and reads back what it wrote.
"""

import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray

INPUT, OUTPUT = "surface.npz", "mesh.npz"


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
    with tempfile.TemporaryDirectory(prefix="physgnn-tetgen-") as folder:
        np.savez(Path(folder) / INPUT, points=points, faces=faces)
        try:
            done = subprocess.run(
                [sys.executable, "-P", __file__, folder, switches],
                cwd=folder,  # where it fails, TetGen leaves files behind
                capture_output=True,
                text=True,
                errors="replace",
                timeout=timeout_s,
                check=False,
            )
        except subprocess.TimeoutExpired as error:
            raise RuntimeError(f"it ran for more than {timeout_s:g} s") from error
        output = Path(folder) / OUTPUT
        if done.returncode != 0 or not output.exists():
            lines = (done.stdout + done.stderr).strip().splitlines()
            raise RuntimeError(lines[-1] if lines else f"exit code {done.returncode}")
        with np.load(output, allow_pickle=False) as mesh:
            return mesh["points"], mesh["cells"], mesh["attribute"]


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

"""One run of a mesher in a process of its own.

Meshers may abort or fault on input that they cannot mesh, and write to standard output;
neither may reach the caller. The script that runs in the process reads arrays from one
file of its folder and writes others to a second.
"""

import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.child_processes import ending_with_us
from physgnn.scratch import scratch_folder

INPUT, OUTPUT = "surface.npz", "mesh.npz"
Arrays = Mapping[str, NDArray[Any]]


def run_script(
    script: str, arrays: Arrays, *options: str, timeout_s: float
) -> dict[str, NDArray[Any]]:
    """Run a mesher's script on arrays and return those that it wrote.

    Parameters
    ----------
    script : str
        Path of the Python file; it gets the folder and the options as arguments.
    arrays : mapping of str to array
        What it finds in ``surface.npz``.
    *options : str
        Further arguments.
    timeout_s : float
        After which it is stopped.

    Raises
    ------
    RuntimeError
        If it fails, faults or takes longer; the message is its last line.
    """
    with scratch_folder("mesher") as folder:
        np.savez(Path(folder) / INPUT, **dict[str, Any](arrays))
        try:
            done = subprocess.run(
                ending_with_us([sys.executable, "-P", script, folder, *options]),
                cwd=folder,  # where it fails, a mesher leaves files behind
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
            return {name: mesh[name] for name in mesh.files}

"""FEBio as a solver: the model written, run, and its log read."""

import shutil
import subprocess
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from physgnn.child_processes import ending_with_us
from physgnn.errors import InputError
from physgnn.io.febio.log import read_febio_log
from physgnn.io.febio.model_writer import log_of, write_febio
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.scratch import scratch_folder

COMMAND = "febio4"
INVERTED = "negative jacobian"


class FebioSolver:
    """A body that FEBio loads; takes the place of `physgnn.mechanics.Solver`.

    Parameters
    ----------
    body : Body
        What is loaded; FEBio's own elements take the place of its elements.

    Raises
    ------
    InputError
        If FEBio is not installed.
    """

    def __init__(self, body: Body) -> None:
        self._body = body
        self._program = find_febio()

    def solve(self, path: LoadPath) -> Solution:
        """Run FEBio along a load path; unreached levels say why.

        Raises
        ------
        InputError
            If FEBio ends without any result; with the last line it printed.
        """
        started = time.perf_counter()
        with scratch_folder("febio") as folder:
            file = Path(folder) / "model.feb"
            write_febio(file, self._body, path)
            printed = self._run(file)
            log = log_of(file)
            if not log.is_file() or log.stat().st_size == 0:
                last = (printed.strip().splitlines() or ["nothing printed"])[-1]
                raise InputError(f"FEBio ended without a result: {last.strip()}")
            times = np.arange(1.0, path.n_levels + 1)
            node_ids = np.arange(1, self._body.mesh.n_points + 1)
            solution = read_febio_log(log, path, times=times, node_ids=node_ids)
        if INVERTED in printed.lower():
            status = solution.status.copy()
            status[status == Status.ITERATION_LIMIT] = Status.INVERTED
            solution = replace(solution, status=status)
        return replace(solution, seconds=time.perf_counter() - started)

    def _run(self, file: Path) -> str:
        done = subprocess.run(
            ending_with_us([self._program, "-i", file.name]),
            cwd=file.parent,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            check=False,  # it also fails when only the last levels are out of reach
        )
        return done.stdout.decode(errors="replace")


def find_febio() -> str:
    """Return FEBio's program; InputError says what to install if there is none."""
    program = shutil.which(COMMAND)
    if program is None:
        raise InputError(
            f"--solver febio needs FEBio 4, but no program '{COMMAND}' is on PATH: "
            "install it from febio.org, or leave --solver out"
        )
    return program

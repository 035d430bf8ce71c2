"""Stands in for FEBio where it is not installed: reads the model, solves it with OUR
solver, and writes the log FEBio would write. It shows that files and statuses are
passed on correctly, and nothing about FEBio's own answers.
"""

import sys
from pathlib import Path

import numpy as np
import pytest

from physgnn.io.febio.model_reader import FebioModel, read_febio
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.equilibrium.solver import Solver


def put_on_path(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the program `febio4` be this file, and any real one invisible."""
    folder.mkdir(exist_ok=True)
    program = folder / "febio4"
    program.write_text(f"#!/bin/sh\nexec {sys.executable} {__file__} $*\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:/usr/bin:/bin")


def write_log(path: Path, model: FebioModel, solution: Solution) -> None:
    """Write converged levels the way FEBio's DataRecord prints them."""
    with path.open("w") as file:
        for level in np.flatnonzero(solution.status == Status.CONVERGED):
            file.write(f"*Step  = {level + 1}\n")
            file.write(f"*Time  = {model.times[level]:.9g}\n*Data  = ux;uy;uz\n")
            rows = zip(model.node_ids, solution.displacement[level], strict=True)
            file.writelines(
                f"{i} {x:.12g} {y:.12g} {z:.12g}\n" for i, (x, y, z) in rows
            )


def main() -> None:
    model = read_febio(sys.argv[sys.argv.index("-i") + 1])
    assert model.log is not None
    body = Solver(Body(model.mesh, model.materials, model.fixed))
    solution = body.solve(model.load_path)
    write_log(model.log, model, solution)
    if solution.message:
        print("Negative jacobian was detected.\n E R R O R   T E R M I N A T I O N")
        sys.exit(1)
    print(" N O R M A L   T E R M I N A T I O N")


if __name__ == "__main__":
    main()

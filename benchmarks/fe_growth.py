"""Time and memory a load path as meshes grow: one body, one load, finer and finer.

    python benchmarks/fe_growth.py --sizes 10000 30000 100000

The bundled brain is meshed with about as many points, its surface refined alike. Every
size is solved in a process of its own, with one thread, and timed in seconds of that
process's CPU, so that other work on the machine counts little. Prints a Markdown table.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.dataset.generation.processes import ONE_THREAD
from physgnn.dataset.presets import BRAIN_AND_TUMOUR, PRESETS
from physgnn.geometry import mni152_phantom
from physgnn.geometry.boundary import boundary_points
from physgnn.geometry.point_sets import select
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import read_mesh, write_mesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.equilibrium.solver import Solver
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.sampling import equal_levels, inward_normals
from physgnn.stages.patient.preoperative.surface_meshing import mesh_surfaces
from tables import load_kernels, machine, table

PATCH_MM, PATCH_FORCE_N, N_LEVELS = 20.0, 4.0, 10  # the same on every mesh
SURFACE_POINTS = 700 / 10_000 ** (2 / 3)  # of a mesh of n points: this times n^(2/3)


def growth(sizes: Sequence[int]) -> None:
    """Print time and memory a path on ever finer meshes of one body, one load."""
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder:
        for size in sizes:
            file = Path(folder) / f"{size}.vtu"
            write_mesh(file, brain(size))
            command = [sys.executable, __file__, "--child", str(file)]
            environment = {**os.environ, **ONE_THREAD}
            done = subprocess.run(
                command, env=environment, capture_output=True, text=True, check=True
            )
            rows.append(json.loads(done.stdout))
    columns = (
        "points",
        "cells",
        "levels",
        "prepare_s",
        "path_s",
        "factorisations",
        "memory_mb",
        "process_mb",
        "factor_made_s",
        "factor_read_s",
    )
    table(columns, ([row[name] for name in columns] for row in rows))
    points = np.log([row["points"] for row in rows])
    seconds = np.array([row["path_s"] for row in rows])
    memory = np.array([row["memory_mb"] for row in rows])
    for what, values in (("time a path", seconds), ("memory", memory)):
        if len(rows) > 1 and (values > 0).all():
            exponent = np.polyfit(points, np.log(values), 1)[0]
            print(f"\n{what} ~ points^{exponent:.2f}")


def brain(size: int) -> TetMesh:
    """Mesh the bundled brain with about as many points, its surface as fine."""
    surface_points = int(np.clip(SURFACE_POINTS * size ** (2 / 3), 300, 5000))
    phantom = mni152_phantom(n_points=surface_points)
    rule = PRESETS["demo"].fixed
    mesh = mesh_surfaces(phantom.brain, phantom.tumours, target_points=size)
    assert rule is not None
    surface = boundary_points(mesh)
    away = np.linalg.norm(mesh.points[surface] - phantom.craniotomy_point, axis=1)
    fixed, loaded = select(mesh, rule), surface[away < PATCH_MM]
    return mesh.with_point_sets(fixed=fixed, loaded=np.setdiff1d(loaded, fixed))


def child(file: Path) -> None:
    """Solve one path on a mesh and print time and memory as JSON."""
    mesh = read_mesh(file)
    loaded = mesh.point_set("loaded")
    direction = inward_normals(mesh, loaded).mean(axis=0)
    direction *= PATCH_FORCE_N / len(loaded) / np.linalg.norm(direction)
    forces = np.tile(direction, (len(loaded), 1))
    path = LoadPath(loaded, forces, equal_levels(N_LEVELS))
    load_kernels()
    forget_peak()
    base = memory_mb("VmRSS")
    start = time.process_time()
    solver = Solver(Body(mesh, BRAIN_AND_TUMOUR))
    prepared = time.process_time()
    solution = solver.solve(path)
    row = {
        "points": mesh.n_points,
        "cells": mesh.n_cells,
        "levels": f"{int((solution.status == Status.CONVERGED).sum())}/{path.n_levels}",
        "prepare_s": round(prepared - start, 2),
        "path_s": round(time.process_time() - prepared, 3),
        "factorisations": solution.counts["factorisations"],
        "memory_mb": round(memory_mb("VmHWM") - base),
        "process_mb": round(memory_mb("VmHWM")),
    }
    with tempfile.TemporaryDirectory() as cache:
        for name in ("factor_made_s", "factor_read_s"):
            start = time.process_time()
            RestState(Body(mesh, BRAIN_AND_TUMOUR), cache=Path(cache))
            row[name] = round(time.process_time() - start, 2)
    print(json.dumps(row))


def memory_mb(name: str) -> float:
    """Return what Linux keeps under a name: VmRSS, now, or VmHWM, the peak."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(name):
            return int(line.split()[1]) / 1024
    raise KeyError(name)


def forget_peak() -> None:
    """Make the peak what memory is now: imports and compilation must not count."""
    Path("/proc/self/clear_refs").write_text("5")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    sizes = [10_000, 30_000, 100_000]
    parser.add_argument("--sizes", type=int, nargs="+", default=sizes)
    parser.add_argument("--child", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        child(options.child)
        return
    print(machine())
    print(f"\n## {N_LEVELS} levels, {PATCH_FORCE_N:g} N on one patch\n")
    growth(options.sizes)


if __name__ == "__main__":
    main()

"""Meshless dynamics beside tetrahedra: error against a refined mesh, and seconds.

    python benchmarks/meshless.py                                  # small: minutes
    python benchmarks/meshless.py --points 9000 --refinements 1    # the demo's own

The bundled brain with its tumour is loaded as in ``refinement.py``. All methods solve
on the same points; the truth is the averaged tetrahedra on cells cut into eight, once
or more. Every load is solved once by every method, one after the other, and timed in
seconds of this process's CPU. Prints a Markdown table.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from physgnn.dataset.generation.pending_paths import CanSolve
from physgnn.dataset.presets import BRAIN_AND_TUMOUR
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import LoadPath, Solver
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import ELEMENTS
from physgnn.mechanics.meshless.options import MeshlessOptions
from physgnn.mechanics.meshless.solver import MeshlessSolver
from refinement import base_mesh, load_paths, point_forces, refine
from tables import load_kernels, machine, table

TRUTH = "tet4-averaged"
COLUMNS = (
    "load",
    "method",
    "levels",
    "error, mm: mean, largest",
    "relative",
    "prepare s",
    "path s",
    "time steps",
)


def methods(mesh: TetMesh, rules: list[int]) -> dict[str, Callable[[], CanSolve]]:
    """Return what makes each solver, by name."""
    body = partial(Body, mesh, BRAIN_AND_TUMOUR)
    found: dict[str, Callable[[], CanSolve]] = {
        element: lambda element=element: Solver(body(element=element))
        for element in ELEMENTS
    }
    for n in rules:
        options = MeshlessOptions(points_per_cell=n)
        found[f"mtled, {n} a cell"] = lambda options=options: MeshlessSolver(
            body(), options=options
        )
    return found


def rows(
    mesh: TetMesh,
    paths: dict[str, LoadPath],
    truth: dict[str, np.ndarray],
    rules: list[int],
) -> Iterator[tuple[Any, ...]]:
    """Solve every load by every method; yield a row of the table for each."""
    for method, make in methods(mesh, rules).items():
        start = time.process_time()
        solver = make()
        prepared = time.process_time() - start
        for load, path in paths.items():
            start = time.process_time()
            solution = solver.solve(path)
            seconds = time.process_time() - start
            n_levels = int((solution.status == 0).sum())
            error = np.linalg.norm(solution.displacement[-1] - truth[load], axis=1)
            relative = np.linalg.norm(error) / np.linalg.norm(truth[load])
            told = ("-", "-")
            if solution.converged:
                told = (f"{error.mean():.3f}, {error.max():.3f}", f"{relative:.1%}")
            steps = solution.counts.get("time_steps", "-")
            done = f"{n_levels}/{path.n_levels}"
            spent = (f"{prepared:.1f}", f"{seconds:.1f}")
            yield (load, method, done, *told, *spent, steps)


def solve_finely(mesh: TetMesh, coarse: TetMesh) -> dict[str, np.ndarray]:
    """Return the truth at the coarse points, which are the first of the fine ones."""
    solver = Solver(Body(mesh, BRAIN_AND_TUMOUR, element=TRUTH))
    found = {}
    for name, path in load_paths(mesh, point_forces(coarse)).items():
        solution = solver.solve(path)
        assert solution.converged, f"{name}: {solution.message}"
        found[name] = solution.displacement[-1][: coarse.n_points]
    return found


def load_all_kernels() -> None:
    """Have everything compiled before time counts."""
    load_kernels()
    mesh = base_mesh(0)
    path = next(iter(load_paths(mesh, point_forces(mesh)).values()))
    options = MeshlessOptions(points_per_cell=1, max_iterations=1)
    MeshlessSolver(Body(mesh, BRAIN_AND_TUMOUR), options=options).solve(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=0, help="about so many, or least")
    parser.add_argument("--refinements", type=int, default=1)
    parser.add_argument("--points-per-cell", type=int, nargs="+", default=[1, 4])
    options = parser.parse_args()
    print(machine())
    mesh = fine = base_mesh(options.points)
    for _ in range(options.refinements):
        fine = refine(fine)
    paths = load_paths(mesh, point_forces(mesh))
    load_all_kernels()
    truth = solve_finely(fine, mesh)
    print(
        f"\n{mesh.n_points} points, {mesh.n_cells} cells; truth: {TRUTH} on "
        f"{fine.n_points} points\n"
    )
    table(COLUMNS, rows(mesh, paths, truth, options.points_per_cell))


if __name__ == "__main__":
    main()

"""The solver against full Newton as FEBio does it, and in bulk.

    python benchmarks/fe.py ../shared/febio --paths 16
    python benchmarks/fe.py ../shared/febio --bulk-only
    python benchmarks/fe.py ../shared/febio --side-by-side 16

The folder holds reference cases, one .npz each: ``points``, ``cells``, ``region``,
``fixed``, ``load_nodes``, ``load_vectors``, and FEBio's ``displacement`` at some
``levels`` of 30. Prints Markdown tables. Everything runs in the same session; FEBio
itself takes part if ``febio4`` is on PATH. Solvers have one thread each; single paths
are timed in seconds of CPU, which other work on the machine disturbs least, bulk and
FEBio by the clock. With ``--side-by-side`` so many of both published datasets' paths
are solved one by one and side by side, and nothing else.
"""

import argparse
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.dataset import Store, generate, verify
from physgnn.dataset.generation.pending_paths import ABREAST
from physgnn.dataset.presets import BRAIN_AND_TUMOUR, PRESETS
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.febio.run import COMMAND, FebioSolver
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.full_newton import Newton
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.equilibrium.solver import Solver
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.sampling import all_node_paths, equal_levels
from tables import load_kernels, machine, table


@dataclass(frozen=True)
class Case:
    """A reference case and FEBio's stored displacements."""

    mesh: TetMesh
    fixed: np.ndarray
    path: LoadPath
    levels: np.ndarray  # of 30, from 1
    displacement: np.ndarray


def read_case(file: Path, n_levels: int) -> Case:
    data = np.load(file)
    mesh = TetMesh(data["points"], data["cells"], data["region"])
    factors = equal_levels(30)[:n_levels]
    path = LoadPath(data["load_nodes"], data["load_vectors"], factors)
    kept = data["levels"] <= n_levels
    solutions = data["levels"][kept], data["displacement"][kept]
    return Case(mesh, data["fixed"], path, *solutions)


def compare(case: Case) -> None:
    """Print time and differences, level by level, of one path."""
    body = Body(case.mesh, BRAIN_AND_TUMOUR, case.fixed)
    solutions: dict[str, np.ndarray] = {}
    rows = []
    solver = Solver(body)
    start = time.process_time()
    ours = solver.solve(case.path)
    seconds = time.process_time() - start
    rows.append(("physgnn", f"{seconds:.2f}", ours.counts["factorisations"], "1"))
    start = time.process_time()
    solutions["full Newton"], factorisations = full_newton(Newton(body), case)
    peer = time.process_time() - start
    rows.append(("full Newton", f"{peer:.2f}", factorisations, f"{peer / seconds:.1f}"))
    if shutil.which(COMMAND):
        febio = FebioSolver(body).solve(case.path)
        solutions["FEBio, now"] = levels_or_nan(febio.displacement, febio.status)
        ratio = f"{febio.seconds / seconds:.1f}"
        rows.append(("FEBio", f"{febio.seconds:.2f}", "", ratio))
    stored = np.full_like(ours.displacement, np.nan)
    stored[case.levels - 1] = case.displacement
    solutions["FEBio, stored"] = stored
    table(("solver", "seconds a path", "factorisations", "times ours"), rows)
    print(
        f"\nlargest distance of a point from ours, mm ({ours.message or 'converged'})"
    )
    found = levels_or_nan(ours.displacement, ours.status)
    distance = [
        np.linalg.norm(solution - found, axis=2).max(axis=1)
        for solution in solutions.values()
    ]
    lines = (
        (
            level + 1,
            *("" if np.isnan(d[level]) else f"{d[level]:.1e}" for d in distance),
        )
        for level in range(case.path.n_levels)
    )
    table(("level", *solutions), lines)


def full_newton(newton: Newton, case: Case) -> tuple[np.ndarray, int]:
    """Step from level to level, each begun where the last one ended, as FEBio does."""
    n_levels = case.path.n_levels
    displacement = np.full((n_levels, case.mesh.n_points, 3), np.nan)
    state = np.zeros((case.mesh.n_points, 3))
    for level in range(n_levels):
        found = newton.solve(case.path.case(level), state)
        if found is None:
            break
        displacement[level] = state = found
    return displacement, newton.factorisations


def levels_or_nan(displacement: np.ndarray, status: np.ndarray) -> np.ndarray:
    return np.where((status == Status.CONVERGED)[:, None, None], displacement, np.nan)


def bulk(case: Case, n_paths: int, workers: int) -> None:
    """Print seconds a path when processes work side by side, and the check."""
    total = float(np.linalg.norm(case.path.forces, axis=1).sum())
    paths = all_node_paths(
        case.mesh,
        case.path.nodes,
        total_force_n=total,
        n_levels=30,
        n_paths=n_paths + 1,
    )[1:]
    factors = case.path.load_factors
    with tempfile.TemporaryDirectory() as folder:
        store = Store.create(
            Path(folder) / "bulk.zarr",
            Body(case.mesh, BRAIN_AND_TUMOUR, case.fixed),
            [LoadPath(path.nodes, path.forces, factors) for path in paths],
            provenance={},
        )
        start = time.perf_counter()
        generate(store, workers=workers)
        wall = time.perf_counter() - start
        start = time.perf_counter()
        checked = verify(store, workers=workers)
        check = time.perf_counter() - start
        converged = f"{len(store.samples())} of {n_paths * case.path.n_levels}"
        seconds = store.seconds.sum() / workers / n_paths
    head = ("processes", "paths", "levels converged", "seconds a path", "with start-up")
    table(
        head, [(workers, n_paths, converged, f"{seconds:.2f}", f"{wall / n_paths:.2f}")]
    )
    print(f"\n{checked}; {check:.1f} s")


def side_by_side(mesh: TetMesh, n_paths: int) -> None:
    """Print CPU seconds a path one by one and side by side, in the same process.

    Half of the paths are solved one by one before, half after.
    """
    rows = []
    for name in ("paper-1", "paper-2"):
        loaded, paths = PRESETS[name].on(mesh)
        body, paths = Body(loaded, BRAIN_AND_TUMOUR), paths[:n_paths]
        alone, together = Solver(body), Solver(body, side_by_side=True)
        half = n_paths // 2
        first, before = timed(map, alone.solve, paths[:half])
        with ThreadPoolExecutor(ABREAST) as threads:
            found, seconds = timed(threads.map, together.solve, paths)
        second, after = timed(map, alone.solve, paths[half:])
        gaps = [
            np.linalg.norm(one.displacement - other.displacement, axis=2).max()
            for one, other in zip([*first, *second], found, strict=True)
        ]
        each = (before + after) / n_paths, seconds / n_paths
        row = (*(f"{x:.2f}" for x in each), f"{1 - each[1] / each[0]:.0%}")
        rows.append((name, n_paths, *row, f"{max(gaps):.0e}"))
    head = ("preset", "paths", "one by one, s a path", "side by side", "saved")
    table((*head, "largest difference, mm"), rows)


def timed(
    apply: Callable[..., Iterable[Solution]], *arguments: Any
) -> tuple[list[Solution], float]:
    start = time.process_time()
    return list(apply(*arguments)), time.process_time() - start


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("cases", type=Path, help="folder of reference cases")
    parser.add_argument(
        "--levels", type=int, default=30, help="of 30, for a quick look"
    )
    parser.add_argument("--paths", type=int, default=16, help="in bulk")
    parser.add_argument("--workers", type=int, default=2, help="processes in bulk")
    parser.add_argument("--bulk-only", action="store_true")
    parser.add_argument("--side-by-side", type=int, metavar="PATHS")
    options = parser.parse_args()
    print(machine())
    load_kernels()
    for file in sorted(options.cases.glob("*.npz")):
        if "load_nodes" not in np.load(file):
            print(f"\n{file.name}: left out, it holds no load path of 30 levels")
            continue
        case = read_case(file, options.levels)
        if options.side_by_side:
            side_by_side(case.mesh, options.side_by_side)
            return
        print(f"\n## {file.stem}: {case.mesh.n_points} points\n")
        if not options.bulk_only:
            compare(case)
        if options.paths and len(case.path.nodes) > 1:
            print("\n### In bulk\n")
            bulk(case, options.paths, options.workers)


if __name__ == "__main__":
    main()

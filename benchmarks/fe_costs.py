"""What materials, elements and loads cost on one brain.

    python benchmarks/fe_costs.py ../shared/febio/febio_ds2_path1.npz

The file is a reference case as `benchmarks/fe.py` takes them. Seconds are of this
process's CPU, with one thread. Prints the tables of docs/results/elements.md.
"""

import argparse
import time
from collections.abc import Callable
from itertools import cycle
from pathlib import Path

import numpy as np

from fe import Case, read_case
from physgnn.dataset.presets import BRAIN_AND_TUMOUR
from physgnn.mechanics import (
    TISSUES,
    Gravity,
    LoadPath,
    MooneyRivlin,
    NeoHookean,
    PrescribedDisplacement,
    Solver,
    SurfacePressure,
    faces_within,
    remove_region,
)
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent
from physgnn.mechanics.elements.tet4 import ELEMENTS, internal_force
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.loads.sampling import equal_levels
from tables import load_kernels, machine, table

LAWS = (
    NeoHookean(3000.0, 0.49),
    MooneyRivlin(250.0, 250.0, 50_000.0),
    TISSUES["brain-ogden"].material,
)
DOWN, TUMOUR, LEVELS = (0.0, 0.0, -1.0), 1, 5


def milliseconds(work: Callable[[], object], times: int = 10) -> str:
    """Mean CPU time of a piece of work, after one that doesn't count."""
    work()
    start = time.process_time()
    for _ in range(times):
        work()
    return f"{1e3 * (time.process_time() - start) / times:.1f}"


def laws(case: Case) -> None:
    """Print what one evaluation of every law costs."""
    u = some_displacement(case)
    rows = []
    for law in LAWS:
        body = Body(case.mesh, {0: law, TUMOUR: law}, case.fixed)
        made, pattern = body.elements, body.pattern
        residual = milliseconds(lambda e=made: internal_force(e, u))
        tangent = milliseconds(lambda e=made, p=pattern: assemble_tangent(e, p, u))
        rows.append((law.law, residual, tangent))
    table(("law", "residual, ms", "tangent, ms"), rows)


def elements(case: Case) -> None:
    """Print what every element costs, piece by piece and for a whole path."""
    u, right = some_displacement(case), None
    rows = []
    for element in ELEMENTS:
        body = Body(case.mesh, BRAIN_AND_TUMOUR, case.fixed, element=element)
        made, pattern = body.elements, body.pattern
        linear = make_linear_solver(pattern, precision="single")
        data, _ = assemble_tangent(made, pattern, np.zeros_like(u))
        right = np.ones(pattern.n_unknowns)
        # Another matrix each time: the same is not factorised again.
        matrices = cycle((data, 2 * data))
        pieces = (
            milliseconds(lambda e=made: internal_force(e, u)),
            milliseconds(lambda e=made, p=pattern: assemble_tangent(e, p, u)),
            f"{len(pattern.indices) / 1e6:.1f} M",
            milliseconds(lambda s=linear, d=matrices: s.factorize(next(d)), 4),
            milliseconds(lambda s=linear, b=right: s.solve(b)),
        )
        rows.append((element, *pieces, *path_costs(case, case.path, element)))
    head = ("element", "residual, ms", "tangent, ms", "entries", "factorise, ms")
    table((*head, "back-solve, ms", "path, s", *COUNTS), rows)


def loads(case: Case) -> None:
    """Print what paths of loads of other kinds cost."""
    z = case.mesh.points[:, 2]
    middle = float(z.min() + z.max()) / 2
    top = np.setdiff1d(np.flatnonzero(z > np.quantile(z, 0.9)), case.fixed)
    faces = faces_within(case.mesh, top)
    nodes = case.path.nodes[:20]
    push = np.tile([0.0, 0.0, -4.0], (len(nodes), 1))
    cases = {
        "gravity, no fluid": (LEVELS, Gravity(DOWN)),
        "gravity, fluid at half height": (
            LEVELS,
            Gravity(DOWN, fluid_level_mm=middle),
        ),
        "300 Pa on the top tenth": (LEVELS, SurfacePressure(faces, 300.0)),
        "1300 Pa (10 mmHg)": (2 * LEVELS, SurfacePressure(faces, 1300.0)),
        f"{len(nodes)} points pushed by 4 mm": (
            LEVELS,
            PrescribedDisplacement(nodes, push),
        ),
    }
    rows = []
    for name, (n, load) in cases.items():
        path = LoadPath.of(equal_levels(n), load)
        rows.append((name, n, *path_costs(case, path)))
    cavity, index = remove_region(case.mesh, TUMOUR)
    fixed = index[case.fixed]
    without = Case(cavity, fixed[fixed >= 0], case.path, case.levels, case.displacement)
    path = LoadPath.of(equal_levels(LEVELS), Gravity(DOWN))
    rows.append(("gravity, tumour resected", LEVELS, *path_costs(without, path)))
    averaged = path_costs(case, path, "tet4-averaged")
    rows.append(("gravity, averaged", LEVELS, *averaged))
    table(("load", "levels", "s", *COUNTS), rows)


COUNTS = ("factorisations", "back-solves", "displacement, mm: mean, largest")


def path_costs(case: Case, path: LoadPath, element: str = "tet4") -> tuple[str, ...]:
    """Return CPU seconds, counts and the last level's displacement of one path."""
    solver = Solver(Body(case.mesh, BRAIN_AND_TUMOUR, case.fixed, element=element))
    start = time.process_time()
    solution = solver.solve(path)
    seconds = time.process_time() - start
    length = np.linalg.norm(solution.displacement[-1], axis=1)
    counts = (solution.counts[name] for name in ("factorisations", "back_solves"))
    end = "" if solution.converged else f", {solution.message}"
    return (
        f"{seconds:.1f}",
        *map(str, counts),
        f"{length.mean():.2f}, {length.max():.2f}{end}",
    )


def some_displacement(case: Case) -> np.ndarray:
    u: np.ndarray = case.displacement[0].astype(np.float64)
    return u


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("case", type=Path, help="a reference case, .npz")
    case = read_case(parser.parse_args().case, 30)
    print(machine())
    load_kernels()
    for name, print_table in (
        ("Materials", laws),
        ("Elements", elements),
        ("Loads", loads),
    ):
        print(f"\n## {name}\n")
        print_table(case)


if __name__ == "__main__":
    main()

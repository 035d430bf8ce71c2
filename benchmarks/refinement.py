"""How far a mesh of ten thousand points is from the continuum: nested refinement.

    python benchmarks/refinement.py                                    # minutes
    python benchmarks/refinement.py --points 9000 --refinements 1      # the demo's own
    python benchmarks/refinement.py --points 0 --elements tet4 tet4-averaged

Every cell is cut into eight, so the body, the fixed points and the loaded patch stay
the same to the last digit, coarse points are fine points, and what differs is the
discretisation alone. Prints Markdown tables.
"""

import argparse
import time
from itertools import pairwise

import numpy as np

from physgnn.dataset.load_rules import PressureOn
from physgnn.dataset.presets import BRAIN_AND_TUMOUR, PRESETS
from physgnn.geometry import mni152_phantom, select, tetrahedralize
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.point_sets import Sphere
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import Gravity, LoadPath, Solver, SolverOptions
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import ELEMENTS
from physgnn.mechanics.loads.sampling import equal_levels, inward_normals

UP = (0.55, 0.35, 0.75)  # of the craniotomy
PATCH_MM, PRESSURE_PA, FORCE_N, LEVELS = 25.0, 300.0, 0.4, 2
SURFACE_POINTS = 700 / 9000 ** (2 / 3)  # of a mesh of n points: this times n^(2/3)
LEAST_POINTS = 1000  # that `tetrahedralize` takes as a target
COLUMNS = (
    "load",
    "points",
    "displacement, mm: mean, largest",
    "change by halving, mm: mean, largest",
    "relative",
    "order",
    "error left, by Richardson: mean mm, relative",
)
EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])
# Corners, then the middles of the edges in that order. Source: Bey 1995, Computing 55.
CHILDREN = np.array(
    [
        [0, 4, 5, 6],
        [4, 1, 7, 8],
        [5, 7, 2, 9],
        [6, 8, 9, 3],
        [4, 5, 6, 8],
        [4, 5, 8, 7],
        [5, 6, 8, 9],
        [5, 7, 9, 8],
    ]
)


def refine(mesh: TetMesh) -> TetMesh:
    """Cut every cell into eight; the old points come first.

    A point set gains the middles of the edges of outer faces wholly in it.
    """
    edges = np.sort(mesh.cells[:, EDGES].reshape(-1, 2), axis=1)
    unique, middle = np.unique(edges, axis=0, return_inverse=True)
    middle = mesh.n_points + middle.reshape(mesh.n_cells, 6)
    cells = np.hstack([mesh.cells, middle])[:, CHILDREN].reshape(-1, 4)
    key = unique @ [mesh.n_points, 1]
    sets = {}
    for name, ids in mesh.point_sets.items():
        faces = boundary_faces(mesh).astype(np.int64)
        faces = faces[np.isin(faces, ids).all(axis=1)]
        sides = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        inside = np.isin(key, sides @ [mesh.n_points, 1])
        sets[name] = np.append(ids, mesh.n_points + np.flatnonzero(inside))
    return TetMesh(
        np.vstack([mesh.points, mesh.points[unique].mean(axis=1)]),
        cells,
        np.repeat(mesh.region, 8),
        sets,
    )


def base_mesh(points: int) -> TetMesh:
    """Mesh the bundled brain, fixed as in the demo, with a patch under the opening.

    Fewer points than can be asked for are as few as the surface allows.
    """
    surface = max(300, round(SURFACE_POINTS * points ** (2 / 3)))
    phantom = mni152_phantom(n_points=surface)
    size: dict[str, float] = {"target_points": points}
    if points < LEAST_POINTS:
        size = {"max_volume_mm3": np.finfo(float).max}
    mesh = tetrahedralize(phantom.brain, phantom.tumours, **size)
    patch = Sphere(tuple(phantom.craniotomy_point.tolist()), PATCH_MM)
    fixed = PRESETS["demo"].fixed
    assert fixed is not None
    return mesh.with_point_sets(fixed=select(mesh, fixed), patch=select(mesh, patch))


def point_forces(mesh: TetMesh) -> LoadPath:
    """Return forces on the points of the patch, along their inward normals."""
    nodes = mesh.point_set("patch")
    forces = FORCE_N / len(nodes) * inward_normals(mesh, nodes)
    return LoadPath(nodes, forces, equal_levels(LEVELS))


def load_paths(mesh: TetMesh, forces: LoadPath) -> dict[str, LoadPath]:
    """Return two distributed loads, and forces on single points."""
    down = Gravity((-UP[0], -UP[1], -UP[2]))
    pressure = PressureOn("patch", PRESSURE_PA).on(mesh)
    factors = forces.load_factors
    return {
        "gravity": LoadPath.of(factors, down),
        f"{PRESSURE_PA:g} Pa on the patch": LoadPath.of(factors, pressure),
        f"{FORCE_N:g} N on {len(forces.nodes)} points": forces,
    }


def length(u: np.ndarray) -> np.ndarray:
    return np.linalg.norm(u, axis=1)


def study(meshes: list[TetMesh], element: str) -> dict[str, list[np.ndarray]]:
    """Solve on all meshes and print what refinement changes; return the solutions."""
    options = SolverOptions(tolerance_mm=1e-5)
    forces = point_forces(meshes[0])
    solutions: dict[str, list[np.ndarray]] = {}
    for mesh in meshes:
        start = time.perf_counter()
        solver = Solver(Body(mesh, BRAIN_AND_TUMOUR, element=element), options=options)
        for name, path in load_paths(mesh, forces).items():
            solution = solver.solve(path)
            assert solution.converged, f"{name}: {solution.message}"
            solutions.setdefault(name, []).append(solution.displacement[-1])
        seconds = time.perf_counter() - start
        print(f"{mesh.n_points} points, {element}: {seconds:.0f} s\n", flush=True)
    print(f"| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}")
    for name, found in solutions.items():
        print_rows(name, found)
    return solutions


def print_rows(name: str, found: list[np.ndarray]) -> None:
    """Print how far each mesh is from the next finer one, at its own points.

    What all further halvings would add is the sum of a geometric series (Richardson);
    its ratio is that of the last two mean changes, over the coarsest mesh's points.
    """
    n = len(found[0])
    steps = [length(b[:n] - a[:n]).mean() for a, b in pairwise(found)]
    order = np.log2(steps[-2] / steps[-1]) if len(steps) > 1 else np.nan
    for u, finer in pairwise(found):
        change = finer[: len(u)] - u
        relative = np.linalg.norm(change) / np.linalg.norm(finer[: len(u)])
        cells = [
            name,
            f"{len(u)}",
            f"{length(u).mean():.3f}, {length(u).max():.2f}",
            f"{length(change).mean():.4f}, {length(change).max():.3f}",
            f"{relative:.1%}",
        ]
        if len(steps) > 1:
            rest = 1 / (1 - 2**-order)
            mean = rest * length(change).mean()
            cells += [f"{order:.2f}", f"{mean:.3f}, {rest * relative:.1%}"]
        print(f"| {' | '.join(cells)} |")


def print_apart(solutions: dict[str, dict[str, list[np.ndarray]]]) -> None:
    """Print how far two elements are apart on the same meshes."""
    one, other = solutions.values()
    print(f"\n| {' and '.join(solutions)} apart | points | mean, largest, mm |")
    print("|---|---|---|")
    for name in one:
        for u, v in zip(one[name], other[name], strict=True):
            apart = length(u - v)
            print(f"| {name} | {len(u)} | {apart.mean():.3f}, {apart.max():.2f} |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=1200, help="of the coarsest mesh")
    parser.add_argument("--refinements", type=int, default=2)
    parser.add_argument("--elements", nargs="+", choices=ELEMENTS, default=["tet4"])
    options = parser.parse_args()
    meshes = [base_mesh(options.points)]
    for _ in range(options.refinements):
        meshes.append(refine(meshes[-1]))
    solutions = {element: study(meshes, element) for element in options.elements}
    if len(solutions) == 2:
        print_apart(solutions)


if __name__ == "__main__":
    main()

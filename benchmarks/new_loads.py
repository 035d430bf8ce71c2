"""Repaired predictions of load paths that training has not seen, most drawn anew.

    python benchmarks/new_loads.py runs/lifted loads.zarr --log new-loads.jsonl
    python benchmarks/new_loads.py runs/lifted loads.zarr --elsewhere 100 …
    python benchmarks/new_loads.py runs/lifted loads.zarr --loads cone …
    python benchmarks/new_loads.py runs/lifted loads.zarr --loads validation …

Each path pushes one point, one of those the store's paths load or of as many others
near them, in directions of the kind that dataset 1 has or within a cone about the
inward normal; `validation` are the paths that the run was validated on, from which
limits may be chosen. True is where the load leads when it grows in 120 steps. Beside
it stand the same in 30 steps, as `physgnn simulate` goes, and where a repair leads that
begins at the prediction however deep the load pushes. What the log has is not measured
again. Prints Markdown.
"""

import argparse
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from held_out import Log, lengths
from physgnn.dataset import Store, named_split
from physgnn.geometry.boundary import boundary_surface
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics import LoadCase, LoadPath, Solver, Status
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.warm_start import WarmStartSolver
from physgnn.mechanics.loads.sampling import (
    cone_paths,
    equal_levels,
    inward_normals,
    uniform_directions,
)
from physgnn.prediction.prediction import Prediction, PredictionStatus
from physgnn.prediction.predictor import Predictor
from physgnn.prediction.repair_policy import SAFETY, depth
from tables import machine, table

FINE, COARSE = 120, 30
GOOD = (PredictionStatus.OK, PredictionStatus.REPAIRED, PredictionStatus.SOLVED)
GROUPS = ((0.0, 0.35), (0.35, 0.7), (0.7, 1.0), (0.0, 1.0))


def loaded_points(store: Store) -> np.ndarray:
    paths = (store.load_path(path) for path in range(store.n_paths))
    return np.unique(np.concatenate([path.nodes for path in paths]))


def points_beside(body: Body, loaded: np.ndarray, how_many: int) -> np.ndarray:
    """Return free points of the surface, the nearest to the middle of the loaded."""
    points = body.mesh.points
    surface = np.unique(boundary_surface(body.mesh).faces)
    others = np.setdiff1d(surface, np.union1d(body.fixed, loaded))
    middle = points[loaded].mean(axis=0)
    distance = np.linalg.norm(points[others] - middle, axis=1)
    return others[np.argsort(distance)[:how_many]]


def oblique_paths(body: Body, nodes: np.ndarray, options) -> list[LoadPath]:
    """Return paths as those of dataset 1: oblique, with the inward normal's signs."""
    random = np.random.RandomState(options.seed)
    drawn = uniform_directions(random, 20 * options.paths)
    x, y, z = np.abs(drawn).T
    oblique = (x < 0.6) & (y < 0.6) & (z > 0.2) & (z < 0.9)
    directions = drawn[oblique][: options.paths]
    chosen = random.choice(nodes, options.paths)
    directions = np.copysign(directions, inward_normals(body.mesh, chosen))
    factors = equal_levels(options.levels)
    return [
        LoadPath(node[None], options.force_n * direction[None], factors)
        for node, direction in zip(chosen, directions, strict=True)
    ]


def directions_within_a_cone(body: Body, nodes: np.ndarray, options) -> list[LoadPath]:
    """Return paths whose directions are up to 60 degrees from the inward normal."""
    return cone_paths(
        body.mesh,
        nodes,
        total_force_n=options.force_n,
        n_levels=options.levels,
        n_paths=options.paths,
        cone_deg=60.0,
        nodes_per_path=1,
        seed=options.seed,
    )


DRAWN = {"oblique": oblique_paths, "cone": directions_within_a_cone}


def validated_on(store: Store, split: str, options) -> list[LoadPath]:
    """Return the validation paths of a split, at other levels."""
    numbers = np.unique(named_split(split, store).validation[:, 0])
    paths = (store.load_path(int(i)) for i in numbers[: options.paths])
    factors = equal_levels(options.levels)
    return [LoadPath(path.nodes, path.forces, factors) for path in paths]


def truths(solver: Solver, path: LoadPath, n_levels: int) -> list[np.ndarray | None]:
    """Return the states at the path's own load factors, growing in so many steps."""
    fine = LoadPath(path.nodes, path.forces, equal_levels(n_levels))
    solution = solver.solve(fine)
    at = np.rint(path.load_factors * n_levels).astype(int) - 1
    return [
        solution.displacement[i] if solution.status[i] == Status.CONVERGED else None
        for i in at
    ]


def far_apart(a: np.ndarray | None, b: np.ndarray | None) -> float:
    return np.nan if a is None or b is None else lengths(a - b)[1]


class Bold:
    """Repairs that trust every prediction."""

    def __init__(self, model: Surrogate, mm: float) -> None:
        body, known = model.body, model.reference_states()
        self._warm_start = WarmStartSolver(body, nearest=known)
        self._within = mm / SAFETY

    def __call__(self, case: LoadCase, guess: np.ndarray) -> np.ndarray | None:
        """Return the equilibrium next to a guess, if there is one."""
        found = self._warm_start.solve(case, guess, tolerance_mm=self._within)
        return found.displacement if found.origin == "guess" else None


def measure(
    predictor: Predictor, bold: Bold, path: LoadPath, number: int, log: Log, mm: float
) -> None:
    """Log what is missing of a path."""
    levels = [(number, level) for level in range(path.n_levels)]
    missing = list(log.missing(levels, "network"))
    if not missing:
        return
    body = predictor.body
    solver = Solver(body)
    true, coarse = (truths(solver, path, n) for n in (FINE, COARSE))
    for _, level in missing:
        case, begun = path.case(level), time.process_time()
        found: Prediction = predictor(case, tolerance_mm=mm)
        processor = time.process_time() - begun
        predicted = predictor.surrogate.predict(case)
        relaxed = predictor.relax(case, predicted).displacement
        log.add(
            path=number,
            level=level + 1,
            what="network",
            load_factor=float(path.load_factors[level]),
            error=far_apart(found.displacement, true[level]),
            coarse=far_apart(coarse[level], true[level]),
            predicted=far_apart(predicted, true[level]),
            depth=depth(body, case, relaxed),
            bold=far_apart(bold(case, relaxed), true[level]),
            physical=lengths(predictor.error(case, predicted))[1],
            status=found.status.name,
            seconds=found.seconds,
            processor_seconds=processor,
        )


def rows(log: Log, mm: float) -> Iterator[tuple[str, ...]]:
    for low, high in GROUPS:
        group = [r for r in log.records if low < r["load_factor"] <= high + 1e-9]
        known = [r for r in group if np.isfinite(r["error"])]
        if not known:
            continue
        good = [r for r in known if PredictionStatus[r["status"]] in GOOD]
        ratio = np.array([r["physical"] / r["predicted"] for r in known])
        coarse = np.array([r["coarse"] for r in known])
        seconds, processor = (
            " / ".join(f"{q:.2f}" for q in np.quantile(times, (0.5, 0.95, 1.0)))
            for times in zip(
                *((r["seconds"], r["processor_seconds"]) for r in group), strict=True
            )
        )
        yield (
            f"{low:g} to {high:g}",
            str(len(group)),
            str(len(group) - len(known)),
            f"{100 * np.mean([r['error'] <= mm for r in known]):.1f} %",
            str(sum(r["error"] > mm for r in good)),
            str(len(known) - len(good)),
            str(int((~(coarse <= mm)).sum())),
            f"{100 * np.mean((ratio >= 0.5) & (ratio <= 2)):.0f} %",
            str(int((ratio < 0.5).sum())),
            seconds,
            processor,
        )


def asked(body: Body, store: Store, options) -> list[LoadPath]:
    if options.loads == "validation":
        return validated_on(store, options.split, options)
    nodes = loaded_points(store)
    if options.elsewhere:
        nodes = points_beside(body, nodes, options.elsewhere)
    return DRAWN[options.loads](body, nodes, options)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run", type=Path)
    parser.add_argument("store", type=Path)
    parser.add_argument(
        "-o", "--out", "--log", dest="log", type=Path, default=Path("new-loads.jsonl")
    )
    parser.add_argument("--loads", default="oblique", choices=[*DRAWN, "validation"])
    parser.add_argument("--split", default="path", help="of the validation paths")
    parser.add_argument("--paths", type=int, default=40)
    parser.add_argument("--levels", type=int, default=6)
    parser.add_argument("--elsewhere", type=int, default=0, metavar="POINTS")
    parser.add_argument("--force-n", type=float, default=1.35)
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--tolerance-mm", type=float, default=0.1)
    options = parser.parse_args()
    print(machine())
    predictor, log = Predictor.load(options.run), Log(options.log)
    bold = Bold(Checkpoint.load(options.run).model, options.tolerance_mm)
    paths = asked(predictor.body, Store.open(options.store), options)
    for number, path in enumerate(paths):
        measure(predictor, bold, path, number, log, options.tolerance_mm)
    head = (
        "load factor",
        "samples",
        "without a truth",
        f"error ≤ {options.tolerance_mm:g} mm",
        "wrong with a good status",
        "said not to be met",
        "wrong in 30 steps",
        "estimate within a factor of 2",
        "too small by more",
        "seconds, 50 / 95 / 100 %",
        "of processor",
    )
    table(head, rows(log, options.tolerance_mm))
    misled = [r["depth"] for r in log.records if r["bold"] > options.tolerance_mm]
    print(f"\nmisled if begun at the prediction: {len(misled)}")
    print("edges deep:", ", ".join(f"{each:.2f}" for each in sorted(misled)))


if __name__ == "__main__":
    main()

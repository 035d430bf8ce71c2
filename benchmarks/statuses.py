"""How often a status is wrong, on loads that nothing was calibrated on.

    OMP_NUM_THREADS=1 python benchmarks/statuses.py

Two hundred loads on the bundled model: round patches of 8 to 40 mm radius about a point
that training loaded, on whatever of the free surface lies within, up to 4 N, within 20
degrees of the inward normal. The truth is the finite-element solution, led from rest.

A prediction is *wrong* if its largest error is above its bound, or above the larger of
0.5 mm and 10 % of the largest displacement. Counted are the predictions that are wrong
and called usable, and those that are right and flagged. Truths are
stored in a folder and not solved again; what the log has is not predicted again. Prints
Markdown.
"""

import argparse
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import torch

from held_out import Log, lengths
from physgnn.arrays import FloatArray
from physgnn.bundled import BUNDLED_RUN
from physgnn.mechanics import LoadCase
from physgnn.mechanics.loads.sampling import within_cone
from physgnn.prediction import (
    FiniteElementPredictor,
    Predict,
    Prediction,
    PredictionStatus,
    Predictor,
)
from physgnn.serving.scene.patch_load import Exposed, spread_force
from tables import machine, table

RADIUS_MM, FORCE_N, CONE_DEG = (8.0, 40.0), (0.1, 4.0), 20.0
WRONG_MM, WRONG_OF_DISPLACEMENT = 0.5, 0.1
ESTIMATES = ("physical", "quick")


def draw(predictor: Predictor, count: int, seed: int) -> Iterator[LoadCase]:
    """Yield fresh loads on the free surface about the trained points."""
    random = np.random.RandomState(seed)
    surface = Exposed.of(predictor.body)
    calibration = predictor.calibration
    assert calibration is not None
    trained = np.array(calibration.trained_range.nodes)
    middles = np.flatnonzero(np.isin(surface.nodes, trained))
    for _ in range(count):
        middle = random.choice(middles)
        radius = float(np.exp(random.uniform(*np.log(RADIUS_MM))))
        force = random.uniform(*FORCE_N)
        direction = within_cone(random, -surface.normals[middle], CONE_DEG)
        yield spread_force(surface, surface.points[middle], force * direction, radius)


def truth_of(solve: Predict, case: LoadCase, file: Path) -> FloatArray | None:
    """Return the finite-element solution, stored in a file; None if there is none."""
    if not file.is_file():
        found = solve(case)
        whole = found.status is PredictionStatus.OK
        np.save(file, found.displacement if whole else np.empty(0))
    solution: FloatArray = np.load(file)
    return solution if len(solution) else None


def measure(
    predictor: Predictor, case: LoadCase, truth: FloatArray, what: str
) -> dict[str, Any]:
    """Return what one prediction says and how wrong it is."""
    found = predictor(case, estimate=what)
    return {
        "nodes": len(case.nodes),
        "force_n": float(np.linalg.norm(case.forces.sum(axis=0))),
        "displacement": lengths(found.displacement)[1],
        "error": lengths(found.displacement - truth)[1],
        "seconds": found.seconds,
        **_said(found),
    }


def _said(found: Prediction) -> dict[str, Any]:
    bound, likely = found.error_estimate_mm, found.likely_error_mm
    return {
        "bound": None if bound is None else bound.max_mm,
        "likely": None if likely is None else likely.max_mm,
        "status": found.status.name,
    }


def is_wrong(record: dict[str, Any]) -> bool:
    """Whether an error is above its bound, or large beside the displacement."""
    error, bound = record["error"], record["bound"]
    allowed = max(WRONG_MM, WRONG_OF_DISPLACEMENT * record["displacement"])
    return error > allowed or (bound is not None and error > bound)


def row(what: str, records: list[dict[str, Any]]) -> tuple[str, ...]:
    usable = [PredictionStatus[r["status"]].usable for r in records]
    wrong = [is_wrong(r) for r in records]
    pairs = list(zip(usable, wrong, strict=True))
    statuses = Counter(r["status"].lower().replace("_", " ") for r in records)
    above = sum(r["bound"] is not None and r["error"] > r["bound"] for r in records)
    return (
        what,
        str(len(records)),
        str(sum(wrong)),
        str(sum(u and w for u, w in pairs)),
        str(sum(not u and not w for u, w in pairs)),
        str(above),
        ", ".join(f"{n} {name}" for name, n in statuses.most_common()),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--truths", type=Path, default=Path("statuses"))
    parser.add_argument("--log", type=Path, default=Path("statuses.jsonl"))
    parser.add_argument("--loads", type=int, default=200)
    parser.add_argument("--seed", type=int, default=2027)
    options = parser.parse_args()
    print(machine())
    torch.set_num_threads(1)
    options.truths.mkdir(parents=True, exist_ok=True)
    predictor, log, lost = Predictor.load(BUNDLED_RUN), Log(options.log), 0
    solve = FiniteElementPredictor(predictor.body)
    for number, case in enumerate(draw(predictor, options.loads, options.seed)):
        file = options.truths / f"{options.seed}-{number}.npy"
        truth = truth_of(solve, case, file)
        if truth is None:
            lost += 1
            continue
        for what in ESTIMATES:
            if list(log.missing([(number, 0)], what)):
                said = measure(predictor, case, truth, what)
                log.add(path=number, level=1, what=what, **said)
    head = (
        "estimate",
        "loads",
        "wrong",
        "wrong and usable",
        "right and flagged",
        "error above its bound",
        "ended",
    )
    table(head, map(row, ESTIMATES, map(log.of, ESTIMATES)))
    print(f"\nloads that finite elements do not reach: {lost}")


if __name__ == "__main__":
    main()

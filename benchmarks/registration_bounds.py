"""What registrations cost and promise, with what was measured good and bad, in silico.

    OMP_NUM_THREADS=1 python benchmarks/registration_bounds.py --cases 12
    OMP_NUM_THREADS=1 python benchmarks/registration_bounds.py --skull sliding

The truth is of `physgnn.evaluation.in_silico.shifts`: a finer mesh, other tissue, other
loads. Each shift is measured five ways (`KINDS`): 40 pairs on the surface, 2000 points
of it, 15 landmarks inside, the whole surface, and the first three together; and each of
these as it is or badly (`CONDITIONS`): a tenth of the points 15 mm off in a random
direction, two swapped, all of them 3 mm and 1.5° off as a whole, which is corrected; so
too "bone" and "bone and outliers", where 6 points of the bone tell the offset. Noise is
0.5 to 1 mm a coordinate, of which the registration is told the middle. A surface has no
points to swap.

A registration is *wrong* if its largest error is above its bound and above 3 mm, what
a surgeon expects of navigation anyway. Counted are the registrations that are wrong and
called ok, and those that are right and flagged. What the log has is not registered
again, and both skulls may share one. Prints Markdown, for each skull, kind and
condition: mean error over cases, how often bounds held with the 95 % interval of
Clopper & Pearson (Biometrika 26, 1934), and bound over error in the median.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

from held_out import USABLE, Log
from physgnn.evaluation.in_silico.cases import BONE_NOISE_MM, Case
from physgnn.evaluation.in_silico.compared import TOLD_MM, Compared
from physgnn.evaluation.in_silico.measurement_errors import (
    KINDS,
    MEASUREMENT_ERRORS,
    clean,
    given,
    offset,
    outliers,
)
from physgnn.evaluation.in_silico.shifts import Truth
from physgnn.registration.inference.bounds import factors_of
from tables import machine, table

HARMLESS_MM = 3.0  # an error below is not called wrong

CONDITIONS = {**MEASUREMENT_ERRORS, "bone": clean, "bone and outliers": outliers}
WITH_BONE = ("bone", "bone and outliers")


def correction_of(name: str) -> str:
    """Return how an offset is corrected where things are measured so."""
    return "by bone" if name in WITH_BONE else "estimated" if name == "offset" else "no"


def registered(body: Compared, kind: str, name: str, case: Case, seed: int) -> dict:
    """Return the errors of one registration and what it said of them."""
    measured = given(case, kind)
    rng = np.random.default_rng(seed + 10_000)
    if name in WITH_BONE:
        both = offset([*measured, case.bone], rng)
        spoilt = [*CONDITIONS[name](both[:-1], rng), both[-1]]
    else:
        spoilt = CONDITIONS[name](measured, rng)
    noise = {**dict.fromkeys(KINDS, TOLD_MM), "bone": BONE_NOISE_MM}
    found = body.registrar(spoilt, noise_mm=noise, rigid_offset=name == "offset")
    there = body.at_truth(found.prediction.displacement)
    error = np.linalg.norm(there - case.displacement, axis=1)
    bound = found.prediction.error_estimate_mm
    assert bound is not None
    skull = body.registrar.skull
    corrected = correction_of(name)
    factors = factors_of(list(KINDS[kind]), skull=skull, corrected=corrected)
    of_mean, of_largest = factors.of_mean, factors.of_largest
    return {
        "raw": [bound.mean_mm / of_mean, bound.max_mm / of_largest],
        "status": found.prediction.status.name,
        "mean": float(error.mean()),
        "max": float(error.max()),
        "bound_mean": bound.mean_mm,
        "bound_max": bound.max_mm,
        "shift": float(np.linalg.norm(found.prediction.displacement, axis=1).max()),
        "surprise": found.held_out_mm,
        "outliers": len(found.outliers),
        "reasons": list(found.prediction.reasons),
        "log_ratio": found.offset.log_ratio,
        "probability": found.offset.probability,
        "offset_mm": found.offset.length_mm,
        "offset_deviation": float(found.offset.deviation_mm.max()),
        "change_mm": found.offset.change_mm,
        "seconds": found.prediction.seconds,
    }


def held(records: Sequence[Mapping[str, Any]], which: str) -> str:
    """Return how often a bound held, with its interval, and how wide it is."""
    kept = sum(r[which] <= r[f"bound_{which}"] for r in records)
    low, high = binomtest(kept, len(records)).proportion_ci(method="exact")
    wide = float(np.median([r[f"bound_{which}"] / r[which] for r in records]))
    return f"{kept / len(records):.0%} ({low:.0%} to {high:.0%}), {wide:.1f}"


def mistakes(records: Sequence[Mapping[str, Any]]) -> tuple[str, str]:
    """Return how many are wrong and called ok, and how many right and flagged."""
    ok = [r["status"] in USABLE for r in records]
    right = [r["max"] <= max(r["bound_max"], HARMLESS_MM) for r in records]
    both = list(zip(ok, right, strict=True))
    return str(both.count((True, False))), str(both.count((False, True)))


def rows(log: Log) -> Iterator[tuple[str, ...]]:
    """Yield a row for each skull, kind, condition, kind with condition, and all."""
    groups: dict[str, list[dict[str, Any]]] = {}
    for record in log.records:
        skull, kind, name = record["what"].split(", ")
        for group in (f"skull {skull}", kind, name, f"{kind}, {name}", "all of them"):
            groups.setdefault(group, []).append(record)
    pairs = (f"{kind}, {name}" for kind in KINDS for name in CONDITIONS)
    order = ("skull fixed", "skull sliding", *KINDS, *CONDITIONS, *pairs, "all of them")
    for group in order:
        records = groups.get(group, [])
        if records:
            error = np.mean([r["mean"] for r in records])
            bounds = held(records, "mean"), held(records, "max")
            counts = str(len(records)), f"{error:.2f}"
            yield group, *counts, *bounds, *mistakes(records)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--log", type=Path, default=Path("registration-bounds.jsonl"))
    parser.add_argument("--cases", type=int, default=12)
    parser.add_argument("--points", type=int, default=1200)
    parser.add_argument("--first-seed", type=int, default=600)
    parser.add_argument("--skull", choices=("fixed", "sliding"), default="fixed")
    parser.add_argument("--causes", choices=("default", "none"), default="default")
    parser.add_argument("--kinds", default=",".join(KINDS))
    usual = [name for name in CONDITIONS if name not in WITH_BONE]
    parser.add_argument("--conditions", default=",".join(usual))
    options = parser.parse_args()
    print(machine())
    skull, log = options.skull, Log(options.log)
    truth = Truth(int(1.5 * options.points), skull)
    causes = None if options.causes == "default" else ()
    body = Compared(options.points, skull, truth.mesh.points, causes)
    ways = [
        (kind, name)
        for name in options.conditions.split(",")
        for kind in options.kinds.split(",")
        if name != "swapped" or "surface" not in kind
    ]
    for seed in range(options.first_seed, options.first_seed + options.cases):
        missing = [
            way
            for way in ways
            if list(log.missing([(seed, 0)], ", ".join((skull, *way))))
        ]
        case = truth.case(seed) if missing else None
        for kind, name in missing:
            assert case is not None
            said = registered(body, kind, name, case, seed)
            log.add(path=seed, level=1, what=f"{skull}, {kind}, {name}", **said)
    head = ("measured", "cases", "mean error, mm")
    head = (*head, "mean bound held, of error", "largest")
    table((*head, "wrong and ok", "right and flagged"), rows(log))


if __name__ == "__main__":
    main()

"""Factors that widen a registration's bounds, and how often they hold elsewhere.

    python benchmarks/registration_factors.py registration-bounds.jsonl

Reads the log of `benchmarks/registration_bounds.py`. A factor is the quantile of error
over the posterior's bound that conformal prediction takes for 90 %. Printed are those
of all shifts, and how often bounds hold for each shift with the factors of the others.
"""

import argparse
import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from registration_bounds import correction_of, held, mistakes
from tables import table

Records = list[dict[str, Any]]


def group_of(record: dict[str, Any]) -> tuple[str, str, str]:
    skull, kind, name = record["what"].split(", ")
    return skull, "several" if kind == "all" else kind, correction_of(name)


def factors(records: Records) -> dict[tuple[str, str, str], tuple[float, ...]]:
    """Return the factors of the mean and the largest error of every group."""
    ratios = defaultdict(list)
    for r in records:
        both = r["mean"] / r["raw"][0], r["max"] / r["raw"][1]
        ratios[group_of(r)].append(both)
    share = {group: min(1.0, 0.9 * (1 + 1 / len(v))) for group, v in ratios.items()}
    return {g: tuple(np.quantile(v, share[g], axis=0)) for g, v in ratios.items()}


def elsewhere(records: Records) -> Records:
    """Return every registration with bounds by the factors of other shifts."""
    found = []
    for seed in sorted({r["path"] for r in records}):
        others = factors([r for r in records if r["path"] != seed])
        for r in (r for r in records if r["path"] == seed):
            of_mean, of_largest = others[group_of(r)]
            most = r["raw"][1] * of_largest
            mean = min(r["raw"][0] * of_mean, most)
            too_large = [s for s in r["reasons"] if "the bound on the error" not in s]
            ok = not too_large and most <= r["shift"]
            bounds = {"bound_mean": mean, "bound_max": most}
            found.append({**r, **bounds, "status": "OK" if ok else "flagged"})
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("log", type=Path)
    lines = parser.parse_args().log.read_text("utf-8").splitlines()
    records = [json.loads(line) for line in lines]
    for group, (mean, largest) in sorted(factors(records).items()):
        print(f"{group}: {mean:.2f}, {largest:.2f}")
    groups: dict[str, Records] = defaultdict(list)
    for r in elsewhere(records):
        skull, kind, name = r["what"].split(", ")
        for group in (f"skull {skull}", kind, name, f"{kind}, {name}", "all of them"):
            groups[group].append(r)
    rows = [
        (g, str(len(v)), held(v, "mean"), held(v, "max"), *mistakes(v))
        for g, v in groups.items()
    ]
    head = ("measured", "cases", "mean bound held, of error", "largest")
    table((*head, "wrong and ok", "right and flagged"), rows)


if __name__ == "__main__":
    main()

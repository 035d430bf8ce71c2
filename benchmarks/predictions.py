"""Time predictions one after another, as a table beside `physgnn evaluate`'s errors.

    OMP_NUM_THREADS=1 python benchmarks/predictions.py paper-2.zarr run-lifted
    OMP_NUM_THREADS=2 python benchmarks/predictions.py paper-2.zarr run-lifted

Test samples of a split, spread over all paths and levels. Of each predictor the
median and the 95th percentile, in ms, and with `--tolerance-mm` those of predictions
by the first run that are made to keep it.
"""

import argparse
import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from physgnn.choices import Estimate
from physgnn.dataset import Store
from physgnn.evaluation import HeldOut, Row, baseline_rows
from physgnn.evaluation.measure.rows import repaired_row, run_rows
from physgnn.mechanics import LoadCase


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("store", type=Path)
    parser.add_argument("runs", type=Path, nargs="+")
    parser.add_argument("--baselines", nargs="*", default=["linear"])
    parser.add_argument("--tolerance-mm", type=float)
    parser.add_argument("--split", default="path")
    parser.add_argument("--cases", type=int, default=30)
    parser.add_argument("--estimate", choices=list(Estimate), default=Estimate.QUICK)
    given = parser.parse_args()
    store = Store.open(given.store)
    held_out = HeldOut.of(store, given.split)
    picks = np.linspace(0, len(held_out.test) - 1, given.cases).round().astype(int)
    cases = [store.load_case(*held_out.test[i]) for i in picks]
    tested = run_rows(given.runs, store)
    rows = baseline_rows(given.baselines, held_out) + tested
    if given.tolerance_mm is not None:
        rows.append(repaired_row(tested[0], given.tolerance_mm))
    print(f"{os.environ.get('OMP_NUM_THREADS', 'all')} threads, {given.cases} cases")
    for row in rows:
        middle, high = 1e3 * np.quantile(
            seconds(row, cases, given.estimate), [0.5, 0.95]
        )
        print(f"{row.name:20} {middle:8.1f} {high:8.1f}", flush=True)


def seconds(row: Row, cases: Sequence[LoadCase], estimate: str) -> list[float]:
    how = {"tolerance_mm": row.tolerance_mm, "estimate": estimate}
    predict = partial(row.make(), **how)
    if row.tolerance_mm is None:  # some factorise when they meet a load of a kind
        for case in cases:
            predict(case)
    return [predict(case).seconds for case in cases]


if __name__ == "__main__":
    main()

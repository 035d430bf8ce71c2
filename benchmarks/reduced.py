"""Accuracy and time of the models without weights, on samples they were not fitted to.

    python benchmarks/reduced.py paper-1.zarr --model reduced --split path
    python benchmarks/reduced.py paper-2.zarr --model galerkin --option pod_modes=96

Prints errors in mm (mean Euclidean; mean over samples of the largest) at every fifth
level, and milliseconds of CPU a prediction, one thread. Every load is predicted twice
and the second time counts: the first may have to factorise.
"""

import argparse
import resource
import time
from pathlib import Path

import numpy as np
import torch

from physgnn.arrays import FloatArray
from physgnn.dataset import Store, named_split
from physgnn.learning.models import build_model
from physgnn.learning.surrogate import Surrogate

LEVELS = np.arange(5, 31, 5)


def measured(
    model: Surrogate, store: Store, path: int, level: int
) -> tuple[float, ...]:
    """Return mean and largest error in mm, and milliseconds."""
    case = store.load_case(path, level)
    model.predict(case)
    start = time.process_time()
    displacement = model.predict(case)
    seconds = time.process_time() - start
    error = np.linalg.norm(displacement - store.displacement(path)[level], axis=1)
    return float(error.mean()), float(error.max()), 1e3 * seconds


def show(name: str, rows: FloatArray) -> None:
    """Print one line of the table."""
    mean, largest = rows[:, 0].mean(), rows[:, 1].mean()
    median, slow = np.median(rows[:, 2]), np.quantile(rows[:, 2], 0.95)
    print(
        f"{name:>8} {mean:.4f} / {largest:.2f} (worst {rows[:, 1].max():.1f}) "
        f"{median:.1f} ms, 95 % ≤ {slow:.1f} ms, {len(rows)} samples"
    )


def main() -> None:
    """Fit on the training part of a split, predict the test part."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("store", type=Path)
    parser.add_argument("--model", choices=("galerkin", "reduced"), default="reduced")
    parser.add_argument("--split", default="path")
    parser.add_argument("--option", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--paths", type=int, help="so many of the tested load paths")
    arguments = parser.parse_args()
    pairs = [option.split("=") for option in arguments.option]
    options = {name: float(v) if "." in v else int(v) for name, v in pairs}
    torch.set_num_threads(1)
    store = Store.open(arguments.store)
    split = named_split(arguments.split, store)
    start = time.process_time()
    model = build_model(arguments.model, store.body, **options)
    model.fit(store, split.train)
    print(f"fitted in {time.process_time() - start:.0f} s, {options}")
    paths = np.unique(split.test[:, 0])[: arguments.paths]
    shown = np.isin(split.test[:, 1] + 1, LEVELS) & np.isin(split.test[:, 0], paths)
    tested = split.test[shown].tolist()
    rows = np.array([measured(model, store, path, level) for path, level in tested])
    level = np.array(tested)[:, 1] + 1
    for each in LEVELS:
        show(str(each), rows[level == each])
    show("all", rows)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"peak memory {peak:.0f} MB, the samples read included")


if __name__ == "__main__":
    main()

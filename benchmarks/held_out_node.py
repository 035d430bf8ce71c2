"""Train on loads round about a point that is never loaded, for tests on that point.

    physgnn simulate paper.vtu --loads examples/around_dataset_1.toml -o around.zarr
    python benchmarks/held_out_node.py around.zarr --like paper-1.zarr -o run-node

Then prints errors in mm (mean Euclidean; mean over samples of the largest) at every
fifth level of `--like`'s test paths, and seconds of CPU; `physgnn evaluate run-node
--split node --store paper-1.zarr` takes all levels. A run that is there is only tested.

The points that split `node` of `--like` holds out for testing and validation are held
out here too: paths that load them serve for nothing else.
"""

import argparse
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physgnn.dataset import Split, Store, named_split
from physgnn.learning.training import train
from physgnn.learning.training_config import TrainingConfig
from physgnn.prediction import Predictor

LEVELS = range(5, 31, 5)


def loaded_points(store: Store, samples: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the points that some samples load."""
    paths = np.unique(samples[:, 0]).tolist()
    return np.unique(np.concatenate([store.load_path(path).nodes for path in paths]))


def split_like(store: Store, other: Store) -> Split:
    """Hold out of a store what split `node` of another holds out of that."""
    held_out = named_split("node", other)
    samples = store.samples()
    nodes = [store.load_path(path).nodes for path in range(store.n_paths)]

    def loads(points: NDArray[np.int64]) -> NDArray[np.bool_]:
        of_path = np.array([np.isin(each, points).any() for each in nodes])
        chosen: NDArray[np.bool_] = of_path[samples[:, 0]]
        return chosen

    test = loads(loaded_points(other, held_out.test))
    validation = loads(loaded_points(other, held_out.validation)) & ~test
    train = ~(test | validation)
    return Split("node", samples[train], samples[validation], samples[test])


def fit(store: Store, other: Store, run: Path, minutes: float) -> None:
    """Train for some minutes of CPU."""
    split = split_like(store, other)
    points = len(loaded_points(store, split.train))
    print(f"{len(split.train)} samples on {points} points")
    config = TrainingConfig(
        model="combined",
        loss="mean_and_largest",
        learning_rate=0.003,
        weight_decay=0.05,
        schedule="cosine",
        early_stopping=1000,
        max_minutes=minutes,
        clock="processor",
    )
    train(store, split, config, run)


def show_errors(run: Path, store: Store) -> None:
    """Print what a run gets wrong on the test paths of split `node`."""
    predictor, rows = Predictor.load(run, warm=False), []
    test = named_split("node", store).test
    for path, level in test[np.isin(test[:, 1] + 1, LEVELS)].tolist():
        start = time.process_time()
        answer = predictor(store.load_case(path, level)).displacement
        seconds = time.process_time() - start
        error = np.linalg.norm(answer - store.displacement(path)[level], axis=1)
        rows.append((level + 1, error.mean(), error.max(), seconds))
    table = np.array(rows)
    for level in LEVELS:
        _, mean, largest, _ = table[table[:, 0] == level].mean(axis=0)
        print(f"{level:>3} {mean:.4f} / {largest:.2f}")
    _, mean, largest, _ = table.mean(axis=0)
    median, slow = np.quantile(table[:, 3], [0.5, 0.95])
    print(f"all {mean:.4f} / {largest:.2f}, {median:.2f} s, 95 % {slow:.2f} s")


def main() -> None:
    """Train and save the run, and test it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("store", type=Path)
    parser.add_argument("--like", type=Path, required=True)
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--minutes", type=float, default=8.0)
    arguments = parser.parse_args()
    other = Store.open(arguments.like)
    if not arguments.out.exists():
        fit(Store.open(arguments.store), other, arguments.out, arguments.minutes)
    show_errors(arguments.out, other)


if __name__ == "__main__":
    main()

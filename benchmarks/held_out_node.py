"""Train on loads round about a point that is never loaded, for tests on that point.

    physgnn simulate paper.vtu --loads examples/around_dataset_1.toml -o around.zarr
    python benchmarks/held_out_node.py around.zarr --like paper-1.zarr -o run-node
    physgnn evaluate run-node --split node --store paper-1.zarr

The points that split `node` of `--like` holds out for testing and validation are held
out here too: paths that load them serve for nothing else.
"""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physgnn.dataset import Split, Store, named_split
from physgnn.learning.training import train
from physgnn.learning.training_config import TrainingConfig


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


def main() -> None:
    """Train and save the run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("store", type=Path)
    parser.add_argument("--like", type=Path, required=True)
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--minutes", type=float, default=8.0)
    arguments = parser.parse_args()
    store = Store.open(arguments.store)
    split = split_like(store, Store.open(arguments.like))
    points = len(loaded_points(store, split.train))
    print(f"{len(split.train)} samples on {points} points")
    config = TrainingConfig(
        model="combined",
        loss="mean_and_largest",
        learning_rate=0.003,
        weight_decay=0.05,
        schedule="cosine",
        early_stopping=1000,
        max_minutes=arguments.minutes,
        clock="processor",
    )
    checkpoint = train(store, split, config, arguments.out)
    print(checkpoint.record["result"])


if __name__ == "__main__":
    main()

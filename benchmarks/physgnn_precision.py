"""A trained PhysGNN's outputs in bfloat16 beside those in float32, on held-out samples.

    physgnn train loads.zarr --precision bfloat16 --max-minutes 8 -o run/
    python benchmarks/physgnn_precision.py run/ loads.zarr --samples 40

Prints means over points and samples, mm: the distance between both outputs, and each
output's error.
"""

import argparse
from pathlib import Path

import numpy as np

from physgnn.dataset import Store, named_split
from physgnn.learning.physgnn.precision import PRECISIONS
from physgnn.prediction.predictor import Predictor
from tables import table


def measure(run: Path, store: Store, samples: np.ndarray) -> list[list[str]]:
    predictors = {p: Predictor.load(run, precision=p, warm=False) for p in PRECISIONS}
    distances = []
    for path, level in samples:
        true = store.displacement(path)[level]
        case = store.load_case(path, level)
        exact, rough = (predictors[p].surrogate.predict(case) for p in PRECISIONS)
        distances.append(
            [
                np.linalg.norm(a - b, axis=1).mean()
                for a, b in ((rough, exact), (exact, true), (rough, true))
            ]
        )
    return [[f"{value:.5f}" for value in np.mean(distances, axis=0)]]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run", type=Path)
    parser.add_argument("store", type=Path)
    parser.add_argument("--split", default="path")
    parser.add_argument("--samples", type=int, default=40)
    options = parser.parse_args()
    store = Store.open(options.store)
    test = named_split(options.split, store).test
    chosen = np.random.default_rng(0).permutation(test)[: options.samples]
    columns = ("bfloat16 from float32", "float32's error", "bfloat16's error")
    table(columns, measure(options.run, store, chosen))


if __name__ == "__main__":
    main()

"""The published weights on another mesh of the brain they were fitted to.

    python benchmarks/physgnn_transfer.py ../shared/paper loads-2.zarr --dataset 2

The store's preset is paper-1 or paper-2, on any mesh of the published surfaces. Points
that no load reaches through six layers are far: the network's output there is the same
whatever the load. Prints mean Euclidean errors by hops from the loads, in mm, beside
what there is to predict.
"""

import argparse
from pathlib import Path

import numpy as np
import torch

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store
from physgnn.learning.graph import graph_of
from physgnn.learning.physgnn.architecture import PUBLISHED_DEPTH as N_LAYERS
from physgnn.learning.physgnn.model import PhysGNNModel
from physgnn.learning.physgnn.published import load_published
from physgnn_speed import CASES
from tables import table

RANGES = {"loaded": (0, 0), "near, 1 to 3 hops": (1, 3), "near, 4 to 6": (4, 6)}
FAR = "far, more than 6"


def published_model(folder: Path, store: Store, dataset: int) -> PhysGNNModel:
    """Return the model with the published weights, and the store's own statistics."""
    configuration, _ = CASES[dataset]
    model = PhysGNNModel(
        store.body,
        configuration=configuration,
        dataset=dataset,
        normaliser="published",
    )
    model.fit(store, store.samples())
    weights = folder / f"config{configuration}_dataset{dataset}.pt"
    model.network = load_published(weights, configuration, dataset)
    return model.eval()


def hops(model: PhysGNNModel, loaded: IntArray) -> IntArray:
    """Return how many edges each point is from the loads, 7 if more than six."""
    graph = graph_of(model.body)
    reached = torch.zeros(graph.n_points, dtype=torch.bool)
    reached[loaded] = True
    found = np.full(len(reached), N_LAYERS + 1)
    for k in range(N_LAYERS + 1):
        found[reached.numpy() & (found > k)] = k
        reached[graph.row[reached[graph.column]]] = True
    return found


def measure(model: PhysGNNModel, store: Store, step: int) -> list[list[str]]:
    """Return a row a range of hops: points, displacement, output, error; means, mm."""
    sums: dict[str, FloatArray] = {}
    for path, level in store.samples()[::step]:
        case = store.load_case(int(path), int(level))
        true = store.displacement(int(path))[level]
        with torch.inference_mode():
            output = model(model.encode(case)[None], graph_of(model.body))[0].numpy()
        away = hops(model, case.nodes)
        lengths = [np.linalg.norm(x, axis=1) for x in (true, output, output - true)]
        groups = {
            name: (away >= first) & (away <= last)
            for name, (first, last) in RANGES.items()
        }
        groups |= {FAR: away > N_LAYERS, "all": away >= 0}
        for name, points in groups.items():
            found = np.array([points.sum(), *(x[points].sum() for x in lengths)])
            sums[name] = sums.get(name, 0.0) + found
    n_samples = len(store.samples()[::step])
    return [
        [name, f"{n / n_samples:.0f}", *(f"{total / n:.3f}" for total in totals)]
        for name, (n, *totals) in sums.items()
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("store", type=Path)
    parser.add_argument("--dataset", type=int, choices=list(CASES), required=True)
    parser.add_argument("--step", type=int, default=37, help="Of so many samples, one.")
    options = parser.parse_args()
    store = Store.open(options.store)
    model = published_model(options.folder, store, options.dataset)
    head = ("points", "how many", "displacement", "output", "error")
    table(head, measure(model, store, options.step))


if __name__ == "__main__":
    main()

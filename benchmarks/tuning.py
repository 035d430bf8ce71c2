"""What other options of the benchmark's methods would give: validation errors.

    python benchmarks/tuning.py paper-2.zarr --split path

Each method learns from the split's training part with its defaults and with the options
below, one changed at a time, and is judged on validation samples. Networks that train
step by step are left out: `physgnn train --config` with other options and the same
minutes compares those. Prints a Markdown table.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch

from physgnn.arrays import IntArray
from physgnn.dataset import SPLITS, Store
from physgnn.learning.models import build_model, resolved_options
from tables import machine, table

TRIED: Mapping[str, Mapping[str, Sequence[Any]]] = {
    "linear-regression": {"penalty": (1e-3, 1.0)},
    "decision-tree": {"smallest_leaf": (2, 20)},
    "random-forest": {"smallest_leaf": (2, 20), "trees": (60,)},
    "extra-trees": {"smallest_leaf": (2, 20), "trees": (60,)},
    "svr": {"cost": (1.0, 100.0), "tube": (0.005, 0.1)},
    "rbf": {"kernel": ("thin_plate_spline", "cubic"), "smoothing": (1e-3,)},
    "mlp": {"width": (256,), "layers": (3,), "epochs": (60,)},
    "pod-network": {"width": (256,), "pod_modes": (64, 256), "epochs": (600,)},
    "galerkin": {"pod_modes": (128,), "k_hops": (2,)},
    "reduced": {"anchors": (256,), "nearest_anchors": (1, 6)},
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("store", type=Path)
    parser.add_argument("--split", choices=SPLITS, default="path")
    parser.add_argument("--methods", nargs="+", choices=TRIED, default=list(TRIED))
    parser.add_argument("--samples", type=int, default=40, help="to judge on, at most")
    given = parser.parse_args()
    torch.set_num_threads(1)
    store = Store.open(given.store, cache_bytes=512 * 2**20)
    split = SPLITS[given.split](store)
    judged_on = split.thinned(given.samples).validation
    print(f"{machine()}; {store.mesh.n_points} points, {len(judged_on)} samples\n")
    rows = []
    for method in given.methods:
        for changed in settings(method):
            error = judged(store, method, changed, (split.train, judged_on))
            said = ", ".join(f"{k} = {v}" for k, v in changed.items())
            rows.append((method, said or "defaults", f"{error:.4g}"))
            print(*rows[-1], flush=True)
    table(("method", "options", "validation, mm"), rows)


def settings(method: str) -> Iterator[dict[str, Any]]:
    """Yield the options of a method that are tried, its defaults first."""
    yield {}
    known = resolved_options(method, {})
    for option, values in TRIED[method].items():
        yield from ({option: value} for value in values if value != known[option])


def judged(
    store: Store,
    method: str,
    options: Mapping[str, Any],
    samples: tuple[IntArray, IntArray],
) -> float:
    """Return the mean error on the second samples of a method fitted to the first."""
    model = build_model(method, store.body, **options)
    model.fit(store, samples[0], 0)
    errors = []
    for path, level in samples[1].tolist():
        found = model.predict(model.sample_case(store, path, level))
        missed = found - store.displacement(path)[level]
        errors.append(np.linalg.norm(missed, axis=1).mean())
    return float(np.mean(errors))


if __name__ == "__main__":
    main()

"""A patient never seen: how a family's network does, beside all there is else.

    python benchmarks/new_patient.py family-run/ loads.zarr --tune tuned/ --runs own/

The family's network is adapted to the store's body, with the loads of its training
paths and none of its solutions. All are tested on the test paths of split ``path``: the
linear solution, the expansion the network starts from, the network, the network after
minutes of fine-tuning on the training paths, and other runs trained on that split.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch

from physgnn.dataset import Store, named_split
from physgnn.dataset.training_loads import strongest_forces
from physgnn.learning.baselines.linear import Linear
from physgnn.learning.runs.adaptation import adapt
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.surrogate import Surrogate
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train
from tables import machine, table

DONE = "tuned"  # a file that says so


def errors(surrogate: Surrogate, store: Store, samples: np.ndarray) -> np.ndarray:
    """Return every point's error in every sample, (n_samples, n_points), mm."""
    found = []
    for path, level in samples.tolist():
        truth = store.displacement(path)[level]
        predicted = surrogate.predict(store.load_case(path, level))
        found.append(np.linalg.norm(predicted - truth, axis=1))
    return np.stack(found)


def tuned(start: Checkpoint, store: Store, minutes: float, run: Path) -> Checkpoint:
    """Return a network trained on from another's weights, for so much processor time.

    What is there already is not trained again.
    """
    if not (run / DONE).exists():
        split = named_split("path", store)
        split = replace(split, validation=split.validation[::8])  # or it costs too much
        config = TrainingConfig(
            model="lifted",
            options=start.record["config"]["options"],
            batch_size=4,
            learning_rate=0.001,
            schedule="cosine",
            early_stopping=1000,
            max_minutes=minutes,
            clock="processor",
        )
        train(store, split, config, run, start=start)
        (run / DONE).touch()
    return Checkpoint.load(run)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path, help="trained on a family")
    parser.add_argument("store", type=Path)
    parser.add_argument("--tune", type=Path, help="folder for a run tuned further")
    parser.add_argument("--minutes", type=float, default=5.0, help="of tuning")
    parser.add_argument("--runs", type=Path, nargs="*", default=[])
    parser.add_argument("--every", type=int, default=5, help="levels: every so many")
    given = parser.parse_args()
    store = Store.open(given.store)
    split = named_split("path", store)
    samples = split.test[(split.test[:, 1] + 1) % given.every == 0]
    family = Checkpoint.load(given.run)
    body = store.body
    print(f"{machine()}; {store.mesh.n_points} points, {len(samples)} samples\n")

    start = time.perf_counter()
    adapted = adapt(family, body, strongest_forces(store, split.train))
    seconds = time.perf_counter() - start
    methods: dict[str, Surrogate] = {"linear solution": Linear(body)}
    methods["family's network"] = adapted.model
    if given.tune:
        model = tuned(family, store, given.minutes, given.tune).model
        methods[f"tuned for {given.minutes:g} minutes"] = model
    for run in given.runs:
        methods[run.name] = Checkpoint.load(run).model
    rows = {name: errors(method, store, samples) for name, method in methods.items()}
    with torch.no_grad():
        adapted.model.get_submodule("local.last").weight.zero_()
        adapted.model.get_submodule("local.last").bias.zero_()
    rows["expansion, untrained"] = errors(methods["family's network"], store, samples)
    table(
        ("", "mean", "mean of maxima", "≤ 1 mm", "mean at full load"),
        [
            (
                name,
                f"{e.mean():.4f}",
                f"{e.max(axis=1).mean():.2f}",
                f"{100 * (e <= 1).mean():.2f} %",
                f"{e[samples[:, 1] == store.n_levels - 1].mean():.3f}",
            )
            for name, e in rows.items()
        ],
    )
    print(f"\nerrors in mm; adapted in {seconds:.1f} s")


if __name__ == "__main__":
    main()

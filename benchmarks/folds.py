"""Fewer predictions with cells turned inside out by fine-tuning: at what price.

    python benchmarks/folds.py runs/lifted loads.zarr --minutes 2

Fine-tunes a lifted run on some of its own training samples from half the load upwards,
once with the loss it was trained with and once with a cost for flattened cells beside
it, and counts on held-out paths. The run itself isn't changed. Prints Markdown.
"""

import argparse
import time
from pathlib import Path

import numpy as np
import torch

from held_out import spread
from physgnn.dataset import Store, named_split
from physgnn.learning.graph import graph_of
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.training.objective.losses import mean_euclidean
from physgnn.learning.training.objective.volume_penalty import VolumePenalty
from tables import machine, table

BATCH, RATE = 4, 3e-4


def encoded(model, store: Store, samples):
    """Return inputs and true displacements of samples, as tensors."""
    pairs = [
        (model.encode(store.load_case(p, n)), torch.tensor(store.displacement(p)[n]))
        for p, n in samples
    ]
    inputs, true = zip(*pairs, strict=True)
    return torch.stack(inputs), torch.stack(true)


def fine_tuned(run: Path, data, weight: float, minutes: float):
    """Return a run's model, trained on for some minutes of processor time."""
    model = Checkpoint.load(run).model.train()
    penalty = VolumePenalty(model.body.mesh)
    optimiser = torch.optim.AdamW(model.parameters(), lr=RATE)
    rng = np.random.default_rng(0)
    end, steps = time.process_time() + 60 * minutes, 0
    while time.process_time() < end:
        some = torch.from_numpy(rng.choice(len(data[0]), BATCH, replace=False))
        predicted = model(data[0][some], graph_of(model.body))
        loss = mean_euclidean(predicted, data[1][some]) + weight * penalty(predicted)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        steps += 1
    return model.eval(), steps


@torch.inference_mode()
def outputs(model, inputs):
    return torch.cat([model(one[None], graph_of(model.body)) for one in inputs])


def judged(model, predicted, true) -> tuple[str, ...]:
    """Return errors and counts of inverted cells as cells of a table."""
    penalty = VolumePenalty(model.body.mesh)
    length = torch.linalg.vector_norm(predicted - true, dim=-1)
    ratios = [penalty.volume_ratio(one[None]) for one in predicted]
    folds = np.array([int((ratio <= 0).sum()) for ratio in ratios])
    return (
        f"{float(length.mean()):.4f}",
        f"{float(length.max(dim=1).values.mean()):.3f}",
        f"{np.count_nonzero(folds)} of {len(folds)}",
        f"{folds.mean():.3f}",
        str(folds.max()),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run", type=Path)
    parser.add_argument("store", type=Path)
    parser.add_argument("--minutes", type=float, default=2.0, help="of processor, each")
    parser.add_argument("--weights", type=float, nargs="*", default=[0.0, 0.02, 0.1])
    parser.add_argument("--per-level", type=int, default=16)
    options = parser.parse_args()
    print(machine())
    store = Store.open(options.store)
    split = named_split("path", store)
    model = Checkpoint.load(options.run).model.eval()
    half = store.n_levels // 2
    parts = [
        encoded(model, store, spread(some[some[:, 1] >= half], options.per_level))
        for some in (split.train, split.test)
    ]
    inputs, true = parts[1]
    expansion = inputs[..., :3] @ model.axes
    rows = [
        ("finite elements", "", *judged(model, true, true)),
        ("expansion alone", "", *judged(model, expansion, true)),
        ("as trained", "", *judged(model, outputs(model, inputs), true)),
    ]
    for weight in options.weights:
        tuned, steps = fine_tuned(options.run, parts[0], weight, options.minutes)
        made = judged(tuned, outputs(tuned, inputs), true)
        rows.append((f"trained on, weight {weight:g}", steps, *made))
    counts = ("predictions with inverted cells", "cells a prediction", "most in one")
    table(("", "steps", "mean error, mm", "largest, mm", *counts), rows)


if __name__ == "__main__":
    main()

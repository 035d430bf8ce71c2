"""What more load paths to learn from are worth: errors over the number of paths.

    physgnn simulate case.vtu --preset paper-2 --training-paths 835 -o more-2.zarr
    python benchmarks/learning_curve.py more-2.zarr -o curve --paths 30 116 300 951

The first so many training paths of the split teach, the same samples test all. Networks
have one budget of processor time. What is measured already is not measured again.
"""

import argparse
import hashlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from physgnn.dataset import SPLITS, Split, Store
from physgnn.evaluation.measure.held_out import HeldOut
from physgnn.evaluation.measure.measuring import measure
from physgnn.evaluation.measure.result import ModelErrors
from physgnn.evaluation.measure.rows import Row
from physgnn.learning.models import build_model, model_class
from physgnn.learning.network import Network
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.record import processor_minutes
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train
from physgnn.prediction.predictor import Predictor
from seeds import settings
from tables import machine, table

VALIDATED = 120  # samples to validate on: more cost what training should have
UNTRAINED: dict[str, dict[str, Any]] = {  # the lifted network before it has learnt
    "expansion": {"relaxed_patches": 0},
    "expansion-relaxed": {},
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("store", type=Path)
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--models", nargs="+", default=["expansion", "lifted"])
    parser.add_argument("--paths", type=int, nargs="+", required=True)
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    parser.add_argument("--split", choices=SPLITS, default="path")
    parser.add_argument("--every", type=int, default=1, help="level to train on")
    parser.add_argument("--minutes", type=float, default=2.5)
    parser.add_argument("--options", type=json.loads, default={}, help="of the model")
    parser.add_argument("--tested", type=int, default=10_000, help="samples at most")
    given = parser.parse_args()
    torch.set_num_threads(1)
    store = Store.open(given.store, cache_bytes=512 * 2**20)
    split = SPLITS[given.split](store).thinned(given.tested)
    print(f"{machine()}; {store.mesh.n_points} points, {len(split.test)} samples\n")
    given.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for model in given.models:
        draws = model not in UNTRAINED and model_class(model).draws
        for n_paths in given.paths:
            part = first_paths(split, n_paths, given.every)
            found = [
                measured(store, part, model, seed, given)
                for seed in (given.seeds if draws else given.seeds[:1])
            ]
            rows.append((model, n_paths, *columns(found)))
    head = ("", "paths", "mean", "largest, per sample", "≤ 1 mm", "loaded region")
    table((*head, "a prediction", "training"), rows)


def first_paths(split: Split, n_paths: int, every: int = 1) -> Split:
    """Return the split with some levels of its first so many paths to train on."""
    paths = list(dict.fromkeys(split.train[:, 0].tolist()))
    if not 1 <= n_paths <= len(paths):
        raise SystemExit(f"--paths: 1 to {len(paths)} teach here (got {n_paths})")
    paths = paths[:n_paths]
    validation = split.thinned(VALIDATED).validation
    train = split.train[np.isin(split.train[:, 0], paths)]
    train = train[(train[:, 1] + 1) % every == 0]
    return replace(split, train=train, validation=validation)


def measured(
    store: Store, split: Split, model: str, seed: int, given: argparse.Namespace
) -> dict[str, Any]:
    """Return errors of a model taught by a part, from its file if there is one."""
    n_paths = len(np.unique(split.train[:, 0]))
    data = (store.content_hash(), split.train.tolist(), split.test.tolist())
    asked = json.dumps([*data, given.options, given.minutes])
    digest = hashlib.sha256(asked.encode()).hexdigest()[:8]  # of all that decides it
    name = f"{model}-{n_paths}-{seed}-{digest}"
    file = given.out / f"{name}.json"
    if not file.exists():
        row = made(store, split, model, seed, given, given.out / name)
        errors = measure(row, HeldOut.of(store, split))
        file.write_text(json.dumps(figures(errors)), encoding="utf-8")
    found: dict[str, Any] = json.loads(file.read_text("utf-8"))
    print(name, found, flush=True)
    return found


def made(
    store: Store,
    split: Split,
    model: str,
    seed: int,
    given: argparse.Namespace,
    run: Path,
) -> Row:
    """Return a row of the table: fitted when measured, or trained now."""
    kind = "lifted" if model in UNTRAINED else model
    if model in UNTRAINED or not issubclass(model_class(kind), Network):
        options = {**UNTRAINED.get(model, {}), **given.options}

        def fitted() -> Predictor:
            surrogate = build_model(kind, store.body, **options)
            surrogate.fit(store, split.train, seed)
            return Predictor(surrogate)

        return Row(model, fitted)
    config = trained_as(kind, store, seed, given)
    folder = RunFolder(run)
    if not folder.model_card.exists():
        train(store, split, config, run, resume=folder.state.exists())
    checkpoint = Checkpoint.load(run)
    checkpoint.model.prepare()
    minutes = processor_minutes(checkpoint.record)
    return Row(model, lambda: Predictor(checkpoint.model), minutes=minutes)


def trained_as(
    model: str, store: Store, seed: int, given: argparse.Namespace
) -> TrainingConfig:
    """Return how a network is trained: as `seeds.py` has it, with this budget."""
    config = settings(model, store, given.options)
    # the last, slow steps of a cosine are its best
    budget = {"max_minutes": given.minutes, "early_stopping": 1000}
    return replace(config, seed=seed, **budget)


def figures(errors: ModelErrors) -> dict[str, Any]:
    """Return what the table has of a measurement."""
    return {
        "mean": errors.euclidean.mean,
        "largest": errors.summary.largest_error_mean,
        "within": errors.euclidean.within_1mm,
        "loaded": errors.by_region["loaded_region"].mean,
        "ms": 1e3 * errors.summary.median_seconds,
        "minutes": errors.minutes,
    }


def columns(found: list[dict[str, Any]]) -> list[str]:
    """Return the cells of a row: means over seeds, with their spread."""
    columns = {key: np.array([each[key] for each in found]) for key in found[0]}
    spread = len(found) > 1

    def cell(key: str, scale: float = 1.0) -> str:
        values = scale * columns[key]
        beside = f" ± {values.std(ddof=1):.2g}" if spread else ""
        return f"{values.mean():.4g}{beside}"

    return [
        *(cell("mean"), cell("largest"), f"{cell('within', 100)} %", cell("loaded")),
        *(f"{columns['ms'].mean():.3g} ms", f"{columns['minutes'].mean():.2g} min"),
    ]


if __name__ == "__main__":
    main()

"""Train networks of several seeds with the same budget, for `physgnn evaluate`.

    python benchmarks/seeds.py paper-2.zarr -o runs --model lifted --seeds 0 1 2
    python benchmarks/seeds.py paper-2.zarr -o runs --model physgnn --seeds 0 1 2
    physgnn evaluate runs/lifted-* runs/physgnn-* --store paper-2.zarr

The budget is processor time, so that runs are alike whatever else the machine does.
Every run folder that is there already is left as it is; an interrupted one is resumed.
"""

import argparse
import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from physgnn.dataset import SPLITS, Split, Store
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.record import processor_minutes
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train
from physgnn.prediction.error_bounds.run_calibration import calibrate_run

THINNED = 8  # every eighth validation sample: validating costs more than this budget
SETTINGS = {
    "lifted": {
        "batch_size": 4,
        "learning_rate": 0.003,
        "weight_decay": 0.1,
        "schedule": "cosine",
    },
    "physgnn": {},  # as published, but for the budget
}
BEST = {"paper-1": (9, 1, 4), "paper-2": (3, 2, 8)}  # configuration, dataset, batch


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("store", type=Path)
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--model", choices=SETTINGS, required=True)
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    parser.add_argument("--split", choices=SPLITS, default="path")
    parser.add_argument("--minutes", type=float, default=6.0)
    parser.add_argument("--options", type=json.loads, default={}, help="of the model")
    given = parser.parse_args()
    store = Store.open(given.store, cache_bytes=128 * 2**20)
    split = SPLITS[given.split](store)
    split = replace(split, validation=split.validation[::THINNED])
    for seed in given.seeds:
        config = settings(given.model, store, given.options)
        config = replace(config, seed=seed, max_minutes=given.minutes)
        finish(store, split, config, given.out / f"{given.model}-{seed}")


def settings(
    model: str, store: Store, options: Mapping[str, Any] | None = None
) -> TrainingConfig:
    chosen, options = dict(SETTINGS[model]), dict(options or {})
    if model == "physgnn":
        best = BEST.get(str(store.provenance.get("preset")), BEST["paper-2"])
        options = {"configuration": best[0], "dataset": best[1], **options}
        chosen["batch_size"] = best[2]
    return TrainingConfig(
        model=model, options=options, memory_mb=4096.0, clock="processor", **chosen
    )


def finish(store: Store, split: Split, config: TrainingConfig, run: Path) -> None:
    if RunFolder(run).calibration.exists():
        return
    resume = RunFolder(run).state.exists()
    checkpoint = train(store, split, config, run, resume=resume)
    calibrate_run(run, store, split)
    result = checkpoint.record["training"]
    minutes = processor_minutes(checkpoint.record)
    print(f"{run}: {result['best_validation_loss']:.4g} mm, {minutes:.1f} min")


if __name__ == "__main__":
    main()

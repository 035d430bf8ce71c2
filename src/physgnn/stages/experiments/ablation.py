"""The paper's ablations, small: aggregation, layer type, depth, jumping knowledge."""

import gc
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from physgnn.dataset import Split, Store, named_split
from physgnn.errors import InputError
from physgnn.evaluation.report.plots.ablation_chart import Point, draw_ablation
from physgnn.io.integrity.atomic import write_whole
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train
from physgnn.progress import Progress
from physgnn.stages.experiments.ablation_panels import (
    ALL,
    PANELS,
    Panel,
    Trial,
    name_of,
    named_panels,
    trials_of,
)
from physgnn.stages.experiments.pipeline import can_resume
from physgnn.stages.outputs import FOLDER, writes

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.evaluation.report.plots.ablation_chart import Point

RESULTS = "ablation.json"
FIGURE = "ablation.png"
BATCH_SIZE = {1: 4, 2: 8}  # as published


@dataclass(frozen=True)
class Ablation:
    """How much to spend on each of the networks.

    Parameters
    ----------
    epochs : int
        Of training; the same for all, whatever they take.
    samples : int
        Training samples of an epoch; a third as many for validation.
    seeds : int
        Networks of each configuration, from other initial weights.
    split : str
        A row of ``SPLITS``.
    width : int
        Channels of the networks' hidden layers.
    precision : str
        Of training, a row of ``PRECISIONS``.
    """

    epochs: int = 3
    samples: int = 400
    seeds: int = 3
    split: str = "published"
    width: int = 112
    precision: str = "float32"

    def __post_init__(self) -> None:
        for name in ("epochs", "samples", "seeds", "width"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} must be > 0 (got {getattr(self, name)})")

    def part_of(self, store: Store) -> Split:
        """Return the samples to train and validate with."""
        whole, rng = named_split(self.split, store), np.random.default_rng(0)
        return replace(
            whole,
            train=rng.permutation(whole.train)[: self.samples],
            validation=rng.permutation(whole.validation)[: -(-self.samples // 3)],
        )


@writes(out=FOLDER)
def ablate(
    out: str | Path,
    *,
    dataset_1: str | Path | None = None,
    dataset_2: str | Path | None = None,
    epochs: int = 3,
    samples: int = 400,
    seeds: int = 3,
    split: str = "published",
    width: int = 112,
    precision: str = "float32",
    panel: str = ALL,
    progress: Progress | None = None,
) -> str:
    """Compare configurations 1 to 12 and others at a reduced budget; call to resume.

    Parameters
    ----------
    out : path
        Gets a run folder a network, ablation.json and ablation.png.
    dataset_1, dataset_2 : path, optional
        Datasets of presets ``paper-1`` and ``paper-2``: one of them, or both.
    epochs, samples, seeds, split, width, precision
        See `Ablation`.
    panel : str
        What to change: rows of `physgnn.stages.experiments.ablation_panels.PANELS`
        with commas between, or ``all``.
    progress : callable, optional
        Called after every network.

    Returns
    -------
    str
        The tables, Markdown.

    Raises
    ------
    InputError
        If no dataset is given, there is no such panel, or the folder's results are of
        another budget.
    """
    panels = named_panels(panel)
    given = {1: dataset_1, 2: dataset_2}
    stores = {number: path for number, path in given.items() if path is not None}
    if not stores:
        raise InputError("give --dataset-1, --dataset-2 or both")
    budget = Ablation(epochs, samples, seeds, split, width, precision)
    return run_ablation(stores, budget, out, panels=panels, progress=progress)


def run_ablation(
    stores: Mapping[int, str | Path],
    budget: Ablation,
    folder: str | Path,
    *,
    panels: Mapping[str, Panel] = PANELS,
    progress: Progress | None = None,
) -> str:
    """Train what is not trained yet; draw ``ablation.png`` and return a table.

    Parameters
    ----------
    stores : mapping of 1 or 2 to path
        The datasets.
    budget : Ablation
        The same for every network.
    folder : path
        Gets a run folder a network, ablation.json and the figure. Two processes may
        share it, one a dataset; a last call with both draws them.
    panels : mapping
        What to change: rows of ``PANELS``.
    progress : callable, optional
        Called after every network.

    Raises
    ------
    InputError
        If the folder's results are of another budget.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    found = _read(folder, budget)
    trials = trials_of(panels, list(stores), budget.seeds)
    for done, trial in enumerate(trials):
        if trial.name not in found:
            loss = _loss(stores[trial.architecture.dataset], trial, budget, folder)
            # Another process may do the other dataset, into the same folder.
            found = {**_read(folder, budget), trial.name: loss}
            _write(folder, budget, found)
            gc.collect()  # Lightning leaves rings of references, to gigabytes of ours
        if progress is not None:
            progress(done + 1, len(trials), trial.name)
    drawn = {
        panel.title: _points(panel, sorted(stores), budget.seeds, found)
        for panel in panels.values()
    }
    draw_ablation(drawn, folder / FIGURE)
    return table(drawn)


def table(panels: Mapping[str, "Sequence[Point]"]) -> str:
    """Return the figure's numbers as Markdown."""
    lines = []
    for title, points in panels.items():
        lines += [f"**{title}**", "", "| dataset | layers | validation loss, mm |"]
        lines.append("|---|---|---|")
        lines += [
            f"| {p.dataset} | {p.replaced} | {np.mean(p.losses):.4f} "
            f"({min(p.losses):.4f}…{max(p.losses):.4f}) |"
            for p in points
        ]
        lines.append("")
    return "\n".join(lines)


def _points(
    panel: Panel, datasets: Sequence[int], seeds: int, found: Mapping[str, float]
) -> "list[Point]":
    from physgnn.evaluation.report.plots.ablation_chart import Point

    return [
        Point(
            dataset,
            number,
            tuple(found[Trial(pair[dataset - 1], seed).name] for seed in range(seeds)),
        )
        for dataset in datasets
        for number, pair in panel.architectures.items()
    ]


def _loss(path: str | Path, trial: Trial, budget: Ablation, folder: Path) -> float:
    store = Store.open(path, cache_bytes=128 * 2**20)
    config = TrainingConfig(
        options={**trial.options, "width": budget.width},
        batch_size=BATCH_SIZE[trial.architecture.dataset],
        schedule="cosine",  # so few epochs have no plateaus
        max_epochs=budget.epochs,
        seed=trial.seed,
        # only jumping knowledge has products in another precision
        precision=budget.precision
        if trial.architecture.jumping_knowledge
        else "float32",
    )
    out = folder / trial.name
    resumed = can_resume(RunFolder(out))
    checkpoint = train(store, budget.part_of(store), config, out, resume=resumed)
    return float(checkpoint.record["training"]["best_validation_loss"])


def _read(folder: Path, budget: Ablation) -> dict[str, Any]:
    file = folder / RESULTS
    if not file.exists():
        return {}
    record = json.loads(file.read_text("utf-8"))
    if record["budget"] != {**asdict(budget), "seeds": record["budget"]["seeds"]}:
        raise InputError(
            f"{folder} holds an ablation of another budget ({record['budget']}): "
            "repeat that, or name another folder"
        )
    return {name_of(key): loss for key, loss in record["losses"].items()}


def _write(folder: Path, budget: Ablation, losses: Mapping[str, float]) -> None:
    record = {"budget": asdict(budget), "losses": losses}
    write_whole(folder / RESULTS, json.dumps(record, indent=2) + "\n")

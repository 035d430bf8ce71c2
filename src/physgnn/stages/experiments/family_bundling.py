"""Make the family run that comes with the package, and measure it on patients unseen.

A network trained on synthetic patients without what belongs to one body, so that
`physgnn adapt` has something to start from on the day it is installed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from physgnn.bundled import BUNDLED_FAMILY
from physgnn.dataset import Store
from physgnn.io import read_mesh
from physgnn.learning.runs.folder import RunFolder
from physgnn.progress import Log, Show, no_log, no_show
from physgnn.stages.datasets.simulation import processes, simulate_mesh
from physgnn.stages.datasets.synthetic_patients import anatomies
from physgnn.stages.experiments.packaged_run import check_size, slim_copy
from physgnn.stages.experiments.pipeline import can_resume
from physgnn.stages.networks.training import train_run
from physgnn.stages.patient.preoperative.adaptation import adapt_run

if TYPE_CHECKING:
    from physgnn.evaluation.measure.result import Report

PRESET = "family"
SETTINGS: dict[str, Any] = {
    "model": "lifted",
    "options": {
        "response_modes": 0,  # they would take 5 MB
        "k_hops": 4,
        "any_axes": True,
    },
    "batch_size": 4,
    "learning_rate": 0.002,
    "weight_decay": 0.1,
    "schedule": "cosine",
    "early_stopping": 1000,
    "clock": "processor",
}
COLUMNS = ("patient", "points", "linear: mean", "largest", "family: mean", "largest")


@dataclass(frozen=True)
class FamilyRecipe:
    """How large a family is, and how long its network trains.

    Attributes
    ----------
    patients, unseen : int
        Synthetic patients to learn from (a third of them to stop by, and for the
        bounds), and others after them to measure on.
    minutes : float
        Of the processor.
    """

    patients: int = 24
    unseen: int = 4
    minutes: float = 9.0


def bundle_family(
    folder: str | Path,
    out: str | Path | None = None,
    *,
    recipe: FamilyRecipe = FamilyRecipe(),
    show: Show = no_show,
    log: Log = no_log,
) -> Path:
    """Make the bundled family run, some half an hour's work; return where it is.

    Parameters
    ----------
    folder : path
        Gets patients, simulations and training; a second call goes on where one ended.
    out : path, optional
        Gets what `physgnn adapt` needs, and the model card; by default the package.
    recipe : FamilyRecipe
        How large the family is.
    show, log : callables
        See `physgnn.stages.experiments.pipeline.Pipeline`.

    Raises
    ------
    InputError
        If it came out larger than the package may carry.
    """
    target, folder = BUNDLED_FAMILY if out is None else Path(out), Path(folder)
    stores = _simulated(folder / "patients", recipe, show)
    run = _trained(stores[: recipe.patients], folder / "run", recipe, show, log)
    rows = [
        _measured(run, store, folder / "unseen" / store.stem, show)
        for store in stores[recipe.patients :]
    ]
    slim_copy(run, target, errors=errors_text(rows))
    check_size(target)
    return target


def _simulated(folder: Path, recipe: FamilyRecipe, show: Show) -> list[Path]:
    count = recipe.patients + recipe.unseen
    with show("meshing") as progress:
        meshes = anatomies(folder, count=count, progress=progress)
    stores = [mesh.with_suffix(".zarr") for mesh in meshes]
    with show("simulating") as progress:
        for i, (mesh, store) in enumerate(zip(meshes, stores, strict=True)):
            progress(i, count, mesh.stem)
            simulate_mesh(read_mesh(mesh), PRESET, store, workers=processes())
    return stores


def _trained(
    stores: Sequence[Path], run: Path, recipe: FamilyRecipe, show: Show, log: Log
) -> Path:
    from physgnn.learning.training.config import TrainingConfig

    if all(file.exists() for file in RunFolder(run).calibrations):
        log(f"{run}: there already")
        return run
    part = run.with_name(f"{run.name}-unfinished")
    config = TrainingConfig(max_minutes=recipe.minutes, **SETTINGS)
    with show("training on a family") as progress:
        resume = can_resume(RunFolder(part))
        train_run(stores, None, config, part, progress=progress, resume=resume)
    part.rename(run)
    return run


def _measured(run: Path, store: Path, out: Path, show: Show) -> tuple[str, "Report"]:
    """Adapt the run to a patient it never saw, and evaluate it there."""
    from physgnn.evaluation.measure.result import Report
    from physgnn.evaluation.run_evaluation import Comparison, evaluate_runs

    made = RunFolder(out).evaluation("mesh")
    if made.report.exists():
        return store.stem, Report.read(made.metrics)
    if not RunFolder(out).record.exists():
        adapt_run(run, Store.open(store).mesh, PRESET, out)
    with show(f"evaluating {store.stem}") as progress:
        report = evaluate_runs(
            [out],
            store,
            "mesh",
            comparison=Comparison("linear"),
            command="physgnn bundle --family",
            progress=progress,
        )
    return store.stem, report


def errors_text(rows: Sequence[tuple[str, "Report"]]) -> str:
    """Return the errors on patients never seen as Markdown, for the model card."""
    from physgnn.evaluation.report.formats import mm
    from physgnn.evaluation.report.tables import Table

    def cells(name: str, points: str, values: Sequence[float]) -> tuple[str, ...]:
        return (name, points, *(mm(value) for value in values))

    figures = [
        [
            number
            for model in (report.model("linear"), report.models[-1])
            for number in (model.euclidean.mean, model.summary.largest_error_mean)
        ]
        for _, report in rows
    ]
    made = [
        cells(name, str(report.facts["case"]["mesh"]).split()[0], values)
        for (name, report), values in zip(rows, figures, strict=True)
    ]
    made.append(cells("mean", "", np.mean(figures, axis=0).tolist()))
    return Table("Patients never seen, mm", COLUMNS, tuple(made)).text()

"""The whole job on the bundled case: brain, mesh, simulations, network, report.

Each step leaves its result under its final name only when it is whole, so a second run
does what is missing and nothing else.
"""

import os
import shutil
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn import stages
from physgnn.dataset import Store
from physgnn.geometry import mni152_phantom
from physgnn.io import read_mesh, write_load_case, write_mesh
from physgnn.progress import Progress

if TYPE_CHECKING:
    from physgnn.evaluation.result import Report

Show = Callable[[str], AbstractContextManager[Progress]]
Log = Callable[[str], None]

TARGET_POINTS = 10_000
TRAINING_MINUTES = 3.0
SPLIT = "path"


def run_demo(folder: str | Path, *, show: Show, log: Log) -> str:
    """Run what is not done yet and return what came out, in a few lines.

    Parameters
    ----------
    folder : path
        Gets case.vtu, loads.zarr, run/, load.json, prediction.vtu and report.html.
    show : callable
        From a title to a context that yields a progress callback.
    log : callable
        Told what is there already.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    store = _simulate(folder, show, log)
    run = _train(folder, store, show, log)
    report = _evaluate(folder, store, run, show, log)
    _predict(folder, store, run, report, show, log)
    return _summary(folder, report)


def _simulate(folder: Path, show: Show, log: Log) -> Store:
    case = folder / "case.vtu"
    if case.exists():
        log(f"{case}: there already")
    else:
        with show("meshing"):
            phantom = mni152_phantom()
            mesh = stages.mesh_surfaces(
                phantom.brain, phantom.tumours, target_points=TARGET_POINTS, log=log
            )
            write_mesh(case, mesh)
    with show("simulating") as progress:
        store, did = stages.simulate(
            read_mesh(case),
            "demo",
            folder / "loads.zarr",
            workers=os.cpu_count() or 1,
            source={"mesh": str(case), "command": "physgnn demo"},
            progress=progress,
        )
    if did.solved == 0:
        log(f"{store.path}: there already")
    return store


def _train(folder: Path, store: Store, show: Show, log: Log) -> Path:
    from physgnn.learning.training_config import TrainingConfig

    run, unfinished = folder / "run", folder / "run-unfinished"
    if run.exists():
        log(f"{run}: there already")
        return run
    config = TrainingConfig(
        model="lifted", schedule="cosine", max_minutes=TRAINING_MINUTES
    )
    with show("training") as progress:
        stages.train(
            store.path,
            SPLIT,
            config,
            unfinished,
            progress=progress,
            resume=(unfinished / "last.ckpt").exists(),
        )
    unfinished.rename(run)
    return run


def _evaluate(folder: Path, store: Store, run: Path, show: Show, log: Log) -> "Report":
    from physgnn.evaluation.result import Report
    from physgnn.evaluation.run import evaluate_run

    report, made = folder / "report.html", run / f"evaluation-{SPLIT}"
    if report.exists():
        log(f"{report}: there already")
        return Report.read(made / "metrics.json")
    with show("evaluating") as progress:
        errors = evaluate_run(
            run, store.path, SPLIT, command="physgnn demo", progress=progress
        )
    part = report.with_name("report.html.part")
    shutil.copyfile(made / "report.html", part)
    part.replace(report)
    return errors


def _predict(
    folder: Path, store: Store, run: Path, report: "Report", show: Show, log: Log
) -> None:
    """Predict one path of the test set at full load."""
    out, load = folder / "prediction.vtu", folder / "load.json"
    if out.exists():
        log(f"{out}: there already")
        return
    sample = report.models[-1].samples[-1]
    case = store.load_case(sample.path, sample.level)
    write_load_case(load, case)
    with show("predicting"):
        stages.predict(run, load, out, linear=True)


def _summary(folder: Path, report: "Report") -> str:
    model, linear = report.models[-1], report.model("linear")
    milliseconds = 1e3 * model.summary.median_seconds
    return (
        f"report:      {folder / 'report.html'}\n"
        f"prediction:  {folder / 'prediction.vtu'}\n"
        f"mean error on load paths never trained on: {model.euclidean.mean:.3f} mm\n"
        f"the linear solution's, beside it:          {linear.euclidean.mean:.3f} mm\n"
        f"a prediction takes {milliseconds:.1f} ms, finite elements "
        f"{report.facts['solver_seconds']:.1f} s"
    )

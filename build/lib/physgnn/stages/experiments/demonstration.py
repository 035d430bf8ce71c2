"""The whole job on the bundled case: brain, mesh, simulations, network, report."""

import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.dataset import Store
from physgnn.io import write_load_case
from physgnn.io.integrity.atomic import whole_file
from physgnn.progress import Log, Show, no_log, no_show
from physgnn.stages.experiments.pipeline import Pipeline
from physgnn.stages.experiments.recipe import RUN, SPLIT, Recipe
from physgnn.stages.outputs import FOLDER, writes
from physgnn.stages.patient.intraoperative.prediction import predict

if TYPE_CHECKING:
    from physgnn.evaluation.measure.result import Report

DEMO = Recipe(
    "physgnn demo",
    surface_points=700,
    target_points=10_000,
    preset="demo",
    training_minutes=1.5,
)
PREDICTION = "prediction.vtu"


@writes(folder=FOLDER)
def demo(
    folder: str | Path = "demo", *, show: Show = no_show, log: Log = no_log
) -> str:
    """Go from the bundled brain to a report; a second call does what is missing.

    Parameters
    ----------
    folder : path
        Gets case.vtu, loads.zarr, run/, load.json, prediction.vtu and report.html.
    show, log : callables
        See `physgnn.stages.experiments.pipeline.Pipeline`.

    Returns
    -------
    str
        What came out, in a few lines.
    """
    pipeline = Pipeline(Path(folder), DEMO.command, show, log)
    report = DEMO.follow(pipeline)
    page = _page(pipeline)
    _predict(pipeline, report)
    return _summary(pipeline, report, page)


def _page(pipeline: Pipeline) -> Path:
    """Bring the report to the top of the folder."""
    made = pipeline.run(RUN).evaluation(SPLIT).report
    page = pipeline.folder / made.name
    if not page.exists() or page.stat().st_mtime < made.stat().st_mtime:
        with whole_file(page) as part:
            shutil.copyfile(made, part)
    return page


def _predict(pipeline: Pipeline, report: "Report") -> None:
    """Predict one path of the test set at full load."""
    load = pipeline.folder / "load.json"
    out = pipeline.folder / PREDICTION
    if pipeline.is_there(out):
        return
    sample = report.models[-1].samples[-1]
    write_load_case(
        load, Store.open(pipeline.store).load_case(sample.path, sample.level)
    )
    with pipeline.show("predicting"):
        predict(pipeline.run(RUN).path, load, out, linear=True)


def _summary(pipeline: Pipeline, report: "Report", page: Path) -> str:
    model, linear = report.models[-1], report.model("linear")
    milliseconds = 1e3 * model.summary.median_seconds
    return (
        f"report:      {page}\n"
        f"prediction:  {pipeline.folder / PREDICTION}\n"
        f"mean error on load paths never trained on: {model.euclidean.mean:.3f} mm\n"
        f"the linear solution's, beside it:          {linear.euclidean.mean:.3f} mm\n"
        f"a prediction takes {milliseconds:.1f} ms, finite elements "
        f"{report.facts['solver_seconds']:.1f} s"
    )

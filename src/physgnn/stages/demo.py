"""The whole job on the bundled case: brain, mesh, simulations, network, report."""

from pathlib import Path
from typing import TYPE_CHECKING

from physgnn import stages
from physgnn.dataset import Store
from physgnn.io import write_load_case
from physgnn.stages.pipeline import Log, Pipeline, Recipe, Show

if TYPE_CHECKING:
    from physgnn.evaluation.result import Report

DEMO = Recipe(
    "physgnn demo",
    surface_points=700,
    target_points=10_000,
    preset="demo",
    training_minutes=1.5,
)
PREDICTION = "prediction.vtu"


def run_demo(folder: str | Path, *, show: Show, log: Log) -> str:
    """Run what is not done yet and return what came out, in a few lines.

    Parameters
    ----------
    folder : path
        Gets case.vtu, loads.zarr, run/, load.json, prediction.vtu and report.html.
    show, log : callables
        See `Pipeline`.
    """
    pipeline = Pipeline(Path(folder), DEMO, show, log)
    report = pipeline.run()
    _predict(pipeline, report)
    return _summary(pipeline, report)


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
        stages.predict(pipeline.trained, load, out, linear=True)


def _summary(pipeline: Pipeline, report: "Report") -> str:
    model, linear = report.models[-1], report.model("linear")
    milliseconds = 1e3 * model.summary.median_seconds
    return (
        f"report:      {pipeline.report}\n"
        f"prediction:  {pipeline.folder / PREDICTION}\n"
        f"mean error on load paths never trained on: {model.euclidean.mean:.3f} mm\n"
        f"the linear solution's, beside it:          {linear.euclidean.mean:.3f} mm\n"
        f"a prediction takes {milliseconds:.1f} ms, finite elements "
        f"{report.facts['solver_seconds']:.1f} s"
    )

"""Make the models that come with the package: the demonstration's, and a family's."""

from dataclasses import replace
from pathlib import Path

from physgnn.bundled import BUNDLED_RUN
from physgnn.progress import Log, Show, no_log, no_show
from physgnn.stages.experiments.demonstration import DEMO
from physgnn.stages.experiments.family_bundling import bundle_family
from physgnn.stages.experiments.packaged_run import check_size, slim_copy
from physgnn.stages.experiments.pipeline import Pipeline
from physgnn.stages.experiments.recipe import RUN
from physgnn.stages.outputs import FOLDER, writes

BUNDLED = replace(
    DEMO,
    command="physgnn bundle",
    training_minutes=4.0,
    options={"response_modes": 0, "pod_modes": 16},  # 64 responses would take 8 MB
    peers=("physgnn",),
    baselines="all",
    tolerance_mm=0.1,
)


@writes(folder=FOLDER, out=FOLDER)
def bundle(
    folder: str | Path,
    out: str | Path | None = None,
    *,
    family: bool = False,
    show: Show = no_show,
    log: Log = no_log,
) -> Path:
    """Make a bundled model, some twenty minutes' work; return where it is.

    Parameters
    ----------
    folder : path
        Gets simulations, training and report; a second call goes on where one ended.
    out : path, optional
        Gets what predictions need, and the model card; by default the package itself.
    family : bool
        Make the family run, for `physgnn adapt`, instead of the demonstration's.
    show, log : callables
        See `physgnn.stages.experiments.pipeline.Pipeline`.

    Returns
    -------
    Path
        The folder of the bundled model.

    Raises
    ------
    InputError
        If it came out larger than the package may carry.
    """
    from physgnn.evaluation.report.tables import accuracy_table

    if family:
        return bundle_family(folder, out, show=show, log=log)
    target = BUNDLED_RUN if out is None else Path(out)
    pipeline = Pipeline(Path(folder), BUNDLED.command, show, log)
    report = BUNDLED.follow(pipeline)
    slim_copy(pipeline.run(RUN).path, target, errors=accuracy_table(report).text())
    check_size(target)
    return target

"""The commands that ask a trained network: how good is it, and what does it say."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import conclude, progress, say, working
from physgnn.cli.options import AffineOption, Displacement, Form, Grid, PrecisionOption


def evaluate(
    runs: Annotated[
        list[Path],
        typer.Argument(
            help="Folders of trained models, the one that the report is about last; "
            "those that differ in their seed alone make one row."
        ),
    ],
    split: Annotated[
        choices.SplitName,
        typer.Option(
            help="Test on the samples that this split holds out; mesh needs --store."
        ),
    ] = "path",
    store: Annotated[
        Path | None,
        typer.Option(
            help="Test on this dataset; by default on the one that the last run was "
            "trained on."
        ),
    ] = None,
    baselines: Annotated[
        str,
        typer.Option(
            help="Compare with these: quick, all, or names with commas between. They "
            "may be whatever has no steps of training among "
            f"{', '.join(choices.names('ModelName'))}, or module:Class."
        ),
    ] = "quick",
    tolerance_mm: Annotated[
        float | None,
        typer.Option(help="Add a row of predictions repaired to this tolerance."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            help="The folder to write the results to; by default evaluation-<split> in "
            "the last run's.",
        ),
    ] = None,
    precision: PrecisionOption = "float32",
) -> None:
    """Measure trained networks on held-out samples: tables, figures, report."""
    with progress("evaluating") as move:
        report = stages.evaluate(
            runs,
            split=split,
            store=store,
            baselines=baselines,
            tolerance_mm=tolerance_mm,
            out=out,
            precision=precision,
            progress=move,
        )
    from physgnn.evaluation.report.tables import accuracy_table, gentle_table
    from physgnn.evaluation.report.verdict import linear_warning
    from physgnn.learning.runs.folder import EvaluationFolder, RunFolder

    made = EvaluationFolder(out) if out else RunFolder(runs[-1]).evaluation(split)
    if warning := linear_warning(report):
        print(f"{warning}\n")
    print(accuracy_table(report).text())
    if gentle := gentle_table(report):
        print(f"\n{gentle.text()}")
    print(f"\nreport: {made.report}")


def predict(
    load: Annotated[Path, typer.Option(help="The load case, JSON.")],
    out: Displacement,
    run: Annotated[
        Path | None,
        typer.Argument(
            help="The folder of a trained model; by default the bundled one."
        ),
    ] = None,
    form: Form = None,
    image: Grid = None,
    tolerance_mm: Annotated[
        float | None,
        typer.Option(
            help="Repair the prediction where its largest error may exceed this."
        ),
    ] = None,
    linear: Annotated[
        bool, typer.Option("--linear", help="Write the linear solution beside it.")
    ] = False,
    precision: PrecisionOption = "float32",
    estimate: Annotated[
        choices.Estimate,
        typer.Option(
            help="Estimate the error this way: by a few steps of the solver, which "
            "says how large it seems and bounds it sharply, or by a quick, coarse "
            "bound."
        ),
    ] = choices.Estimate.PHYSICAL,
    affine: AffineOption = None,
) -> None:
    """Predict the displacement under one load case.

    The exit code is 3 if the displacement that is written is not ok.
    """
    with working("predicting"):
        found = stages.predict(
            run,
            load,
            out,
            form=form,
            image=image,
            tolerance_mm=tolerance_mm,
            linear=linear,
            precision=precision,
            estimate=estimate,
            affine=affine,
            log=say,
        )
    largest = (found.displacement**2).sum(axis=1).max() ** 0.5
    bounds, likely = found.error_estimate_mm, found.likely_error_mm
    error = "" if likely is None else f", error likely {likely.max_mm:.2g} mm"
    bound = "" if bounds is None else f", error at most {bounds.max_mm:.2g} mm"
    chance = "" if bounds is None else f" ({bounds.coverage:.0%} of cases)"
    print(
        f"{out}: largest displacement {largest:.2f} mm{error}{bound}{chance}, "
        f"{1e3 * found.seconds:.1f} ms; {found.status}: "
        f"{found.status.remedy_for('predict')}"
    )
    conclude(found.status, found.reasons)

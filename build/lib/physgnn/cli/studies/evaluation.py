"""The command that asks how good trained networks are."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import progress
from physgnn.cli.options import PrecisionOption


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

"""The commands that ask a trained network: how good is it, and what does it say."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import stages
from physgnn.bundled import BUNDLED_RUN
from physgnn.cli.console import progress, working

Out = Annotated[
    Path,
    typer.Option(
        "--out",
        "-o",
        help=".vtu (at rest, with the displacement), .vtp (deformed surfaces), .h5 "
        "(transform for ITK and 3D Slicer) or .nii.gz (displacement field).",
    ),
]
Form = Annotated[
    str | None,
    typer.Option(
        "--as",
        help="What to write where the suffix leaves a choice: rest, deformed (.vtu); "
        "field, itk-field, labels (.nii.gz).",
    ),
]
Grid = Annotated[
    Path | None,
    typer.Option("--image", help="NIfTI whose voxels a field or label map gets."),
]


Precision = Annotated[
    str, typer.Option(help="float32, or for PhysGNN bfloat16: quicker, rougher.")
]


def evaluate(
    runs: Annotated[
        list[Path],
        typer.Argument(help="Folders of trained models; seeds of one make one row."),
    ],
    split: Annotated[
        str, typer.Option(help="path, node, published, or mesh (with --store).")
    ] = "path",
    store: Annotated[
        Path | None, typer.Option(help="Dataset; by default the one trained on.")
    ] = None,
    baselines: Annotated[
        str,
        typer.Option(
            help="quick, all, or names of methods with commas between, module:Class "
            "of your own too."
        ),
    ] = "quick",
    tolerance_mm: Annotated[
        float | None, typer.Option(help="Add a row that repairs what exceeds this.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder; else in the last run's.")
    ] = None,
    precision: Precision = "float32",
) -> None:
    """Measure trained networks on held-out samples: tables, figures, report."""
    data = stages.store_of(runs[-1]) if store is None else store
    with progress("evaluating") as move:
        from physgnn.evaluation.run import Comparison, evaluate_runs
        from physgnn.evaluation.tables import accuracy_table

        report = evaluate_runs(
            runs,
            data,
            split,
            comparison=Comparison(baselines, tolerance_mm, precision),
            out=out,
            command=stages.command_line(),
            progress=move,
        )
    print(accuracy_table(report).text())
    print(f"\nreport: {(out or runs[-1] / f'evaluation-{split}') / 'report.html'}")


def predict(
    load: Annotated[Path, typer.Option(help="Load case, JSON.")],
    out: Out,
    run: Annotated[
        Path | None,
        typer.Argument(help="Folder of a trained model; by default the bundled one."),
    ] = None,
    form: Form = None,
    image: Grid = None,
    tolerance_mm: Annotated[
        float | None, typer.Option(help="Solve instead if the error may exceed this.")
    ] = None,
    linear: Annotated[
        bool, typer.Option("--linear", help="Write the linear solution too.")
    ] = False,
    precision: Precision = "float32",
    estimate: Annotated[
        str, typer.Option(help="Of the error: physical, or quick: a coarser bound.")
    ] = "physical",
) -> None:
    """Predict the displacement under one load case."""
    with working("predicting"):
        answer = stages.predict(
            run or BUNDLED_RUN,
            load,
            out,
            form=form,
            image=image,
            tolerance_mm=tolerance_mm,
            linear=linear,
            precision=precision,
            estimate=estimate,
        )
    largest = (answer.displacement**2).sum(axis=1).max() ** 0.5
    bounds, likely = answer.error_estimate_mm, answer.likely_error_mm
    error = "" if likely is None else f", error likely {likely.max_mm:.2g} mm"
    bound = "" if bounds is None else f", error at most {bounds.max_mm:.2g} mm"
    chance = "" if bounds is None else f" ({bounds.coverage:.0%} of cases)"
    print(
        f"{out}: largest displacement {largest:.2f} mm{error}{bound}{chance}, "
        f"{1e3 * answer.seconds:.1f} ms; {answer.status}: {answer.status.remedy}"
    )

"""The command that asks a trained network for a displacement."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import conclude, say, working
from physgnn.cli.options import AffineOption, Displacement, Form, Grid, PrecisionOption


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
        f"{found.seconds:.1f} s with what is factorised once; {found.status}: "
        f"{found.status.remedy_for('predict')}"
    )
    conclude(found.status, found.reasons)

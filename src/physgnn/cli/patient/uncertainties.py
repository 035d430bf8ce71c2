"""The command that shows how far to trust a displacement."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import stages
from physgnn.cli.console import conclude_stored, say, working
from physgnn.cli.options import AffineOption, OutFile, SeriesOption


def uncertainty(
    prediction: Annotated[
        Path, typer.Argument(help="A displacement written by register, VTU.")
    ],
    image: Annotated[
        Path, typer.Argument(help="The patient's image, whose voxels are taken.")
    ],
    out: OutFile,
    wrong: Annotated[
        Path | None,
        typer.Option(
            help="Write the probability that the position is wrong by more than "
            "--wrong-mm to this image."
        ),
    ] = None,
    wrong_mm: Annotated[
        float, typer.Option(help="Call a position wrong beyond so many mm.")
    ] = 2.0,
    deformed: Annotated[
        bool,
        typer.Option(
            "--deformed",
            help="Show the brain where it is now, to lay over a warped image.",
        ),
    ] = False,
    affine: AffineOption = None,
    series: SeriesOption = None,
) -> None:
    """Write the standard deviation of a displacement as an image.

    The exit code is 3 if the displacement is not ok.
    """
    from physgnn.io.medical.images.formats import named_like

    with working("drawing the uncertainty"):
        stages.uncertainty(
            prediction,
            image,
            out,
            wrong=wrong,
            wrong_mm=wrong_mm,
            deformed=deformed,
            affine=affine,
            series=series,
            log=say,
        )
    for path in (out, wrong):
        if path is not None:
            print(named_like(path, image, labels=False))
    conclude_stored(prediction)

"""The command from a scan to a label map."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import say, working
from physgnn.cli.options import AffineOption, AnySizeOption, OutFile


def segment(
    scan: Annotated[
        Path,
        typer.Argument(
            help="The MR scan of a head, an image or a folder of DICOM; its skull may "
            "have been taken off."
        ),
    ],
    out: OutFile,
    backend: Annotated[
        choices.BrainBackend,
        typer.Option(
            help="Find the brain by this program; auto takes the first that is "
            "installed and serves the contrast."
        ),
    ] = "auto",
    contrast: Annotated[
        choices.Contrast, typer.Option(help="Say which contrast the scan has.")
    ] = "t1",
    ventricles: Annotated[
        bool,
        typer.Option(
            "--ventricles/--no-ventricles", help="Look for the ventricles, or do not."
        ),
    ] = True,
    tumour: Annotated[
        Path | None,
        typer.Option(
            help="Grow tumours from these points (CSV, .fcsv or .mrk.json), or add "
            "this label map."
        ),
    ] = None,
    tumour_labels: Annotated[
        str | None,
        typer.Option(help="Take these labels of that map for tumour, such as 1+4."),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(
            help="Draw the outlines to this PNG file instead of one beside the result."
        ),
    ] = None,
    any_size: AnySizeOption = False,
    affine: AffineOption = None,
) -> None:
    """Find brain, ventricles and tumour in a scan, for mesh to take."""
    with working("segmenting"):
        stages.segment(
            scan,
            out,
            backend=backend,
            contrast=contrast,
            ventricles=ventricles,
            tumour=tumour,
            tumour_labels=tumour_labels,
            picture=picture,
            any_size=any_size,
            affine=affine,
            log=say,
        )
    print(out)

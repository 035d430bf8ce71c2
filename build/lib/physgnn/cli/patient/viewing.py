"""The live view's command."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import stages
from physgnn.cli.console import say
from physgnn.cli.options import AffineOption


def view(
    path: Annotated[
        Path | None,
        typer.Argument(
            help="A run folder or a case, VTU; by default the bundled model."
        ),
    ] = None,
    port: Annotated[
        int,
        typer.Option(
            min=0,
            max=65535,
            help="Serve on this port of 127.0.0.1; 0 takes a free one.",
        ),
    ] = 8750,
    image: Annotated[
        Path | None,
        typer.Option(help="Show sections of this image, or of mni152."),
    ] = None,
    igtl: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=65535,
            help="Stream the deformation by OpenIGTLink from this port.",
        ),
    ] = None,
    save: Annotated[
        Path | None,
        typer.Option(
            help="Keep craniotomies and registrations of a case in this folder."
        ),
    ] = None,
    igtl_surfaces: Annotated[
        bool,
        typer.Option("--igtl-surfaces", help="Stream the deformed surfaces too."),
    ] = False,
    affine: AffineOption = None,
) -> None:
    """Load the brain in the browser and see it deform."""
    stages.view(
        path,
        port=port,
        image=image,
        affine=affine,
        igtl=igtl,
        igtl_surfaces=igtl_surfaces,
        save=save,
        log=say,
    )

"""The live view's command."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn.cli.console import say


def view(
    path: Annotated[
        Path | None,
        typer.Argument(help="Run folder or mesh; by default the bundled model."),
    ] = None,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="On 127.0.0.1; 0 takes a free one.")
    ] = 8750,
    image: Annotated[
        Path | None, typer.Option(help="NIfTI volume for sections, or mni152.")
    ] = None,
    igtl: Annotated[
        int | None,
        typer.Option(min=0, max=65535, help="Stream by OpenIGTLink from this port."),
    ] = None,
    igtl_surfaces: Annotated[
        bool,
        typer.Option("--igtl-surfaces", help="Stream the deformed surfaces too."),
    ] = False,
) -> None:
    """Push the brain in the browser and see it follow."""
    from physgnn.serving import serve

    serve(path, port=port, image=image, igtl=igtl, igtl_surfaces=igtl_surfaces, log=say)

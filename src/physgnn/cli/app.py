"""The commands: each parses, calls its function in `physgnn.stages`, and prints."""

import os
import sys

import typer

from physgnn.cli import (
    exchange,
    experiments,
    images,
    materials,
    patients,
    predictions,
    simulation,
    training,
    viewing,
)
from physgnn.cli.console import say
from physgnn.errors import InputError

app = typer.Typer(
    help="Real-time prediction of brain deformation: mesh, finite elements, networks.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.command()(simulation.mesh)
app.command()(simulation.simulate)
app.command()(training.train)
app.command()(predictions.evaluate)
app.command()(predictions.predict)
app.command()(exchange.export)
app.command("import")(exchange.import_results)
app.command()(experiments.demo)
app.command(hidden=True)(experiments.bundle)
app.command()(experiments.published)
app.command()(experiments.reproduce)
app.command()(experiments.ablate)
app.command()(materials.fit_material)
app.command()(patients.anatomies)
app.command()(patients.adapt)
app.command()(images.warp)
app.command()(images.register)
app.command()(viewing.view)


def main() -> None:
    """Run the command line; wrong input is one line on standard error and exit 2."""
    if int(os.environ.get("LOCAL_RANK", 0)) > 0:  # the first process speaks for all
        sys.stdout = sys.stderr = open(os.devnull, "w")  # noqa: PTH123, SIM115
    try:
        app()
    except InputError as error:
        say(f"physgnn: {error}")
        sys.exit(2)
    except OSError as error:
        say(f"physgnn: {error.strerror or error}: {error.filename or ''}".rstrip(": "))
        sys.exit(2)

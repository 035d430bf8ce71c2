"""The commands: each parses, calls its function in `physgnn.stages`, and prints."""

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
    uncertainty,
    viewing,
)
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
app.command()(experiments.selftest)
app.command()(experiments.reproduce)
app.command()(experiments.ablate)
app.command()(materials.fit_material)
app.command()(patients.anatomies)
app.command()(patients.adapt)
app.command()(images.warp)
app.command()(images.register)
app.command()(uncertainty.uncertainty)
app.command()(viewing.view)


def run() -> int:
    """Run the command that the arguments name, and return its exit code.

    Raises
    ------
    InputError
        If an argument is unknown, missing or wrong.
    """
    arguments = sys.argv[1:] or ["--help"]
    command = typer.main.get_command(app)
    try:
        with command.make_context("physgnn", arguments) as context:
            command.invoke(context)
    except typer.Exit as ended:
        return ended.exit_code
    except typer.TyperException as error:
        raise InputError(_line(error)) from error
    return 0


def _line(error: typer.TyperException) -> str:
    """Return what is wrong with the arguments, and of which command, in one line."""
    context = getattr(error, "ctx", None)
    text = " ".join(getattr(error, "format_message", error.__str__)().split())
    text = text.replace("Value error, ", "")  # pydantic's, of a choice
    command = "physgnn" if context is None else context.command_path
    return f"{text.rstrip('.')} (see {command} --help)"

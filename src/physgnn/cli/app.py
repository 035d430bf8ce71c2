"""The commands: each parses, calls its function in `physgnn.stages`, and prints."""

import inspect
import sys

import typer

from physgnn.cli import (
    exchange,
    experiments,
    images,
    materials,
    patients,
    predictions,
    registrations,
    segmenting,
    simulation,
    training,
    uncertainties,
    viewing,
)
from physgnn.errors import InputError
from physgnn.stages.naming import COMMANDS

app = typer.Typer(
    help="Real-time prediction of brain deformation: mesh, finite elements, networks.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
MODULES = (
    segmenting,
    simulation,
    training,
    predictions,
    exchange,
    experiments,
    materials,
    patients,
    images,
    registrations,
    uncertainties,
    viewing,
)
"""Every public function that one of these defines is a command, in this order."""
HIDDEN = frozenset({"bundle"})
"""Commands that the help does not list: they are for those who make a release."""
NAMES = {function: command for command, function in COMMANDS.items()}


def _register() -> None:
    for module in MODULES:
        for name, function in vars(module).items():
            its_own = getattr(function, "__module__", "") == module.__name__
            if its_own and inspect.isfunction(function) and not name.startswith("_"):
                app.command(NAMES[name], hidden=name in HIDDEN)(function)


_register()


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

"""The commands: each parses, calls its function in `physgnn.stages`, and prints."""

import inspect
import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from pkgutil import iter_modules
from typing import Annotated

import typer

from physgnn.cli import patient, studies
from physgnn.cli.strict_command import StrictCommand
from physgnn.errors import InputError
from physgnn.stages.naming import COMMANDS
from physgnn.versions import release

app = typer.Typer(
    help="Real-time prediction of brain deformation: mesh, finite elements, networks.",
    no_args_is_help=True,
    invoke_without_command=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
MODULES = tuple(
    import_module(f"{room.__name__}.{found.name}")
    for room in (patient, studies)
    for found in iter_modules(room.__path__)
)
"""Every public function that one of these defines is a command."""
WORKFLOW = (
    "segment", "mesh", "init", "simulate", "train", "evaluate", "adapt", "predict",
    "register", "warp", "uncertainty", "view", "batch",
)  # fmt: skip
"""What the help lists first, in the order of use; the other commands follow."""
HIDDEN = frozenset({"bundle"})
"""Commands that the help does not list: they are for those who make a release."""
NAMES = {function: command for command, function in COMMANDS.items()}


@app.callback()
def _before_any_command(
    version: Annotated[
        bool, typer.Option("--version", help="Print which release this is.")
    ] = False,
) -> None:
    if version:
        print(f"physgnn {release('physgnn')}")
        raise typer.Exit


def _commands() -> Iterator[tuple[str, Callable[..., None]]]:
    for module in MODULES:
        for name, function in vars(module).items():
            its_own = getattr(function, "__module__", "") == module.__name__
            if its_own and inspect.isfunction(function) and not name.startswith("_"):
                yield NAMES[name], function


def _register() -> None:
    found = dict(_commands())
    for name in sorted(found, key=(*WORKFLOW, *found).index):
        app.command(name, cls=StrictCommand, hidden=name in HIDDEN)(found[name])


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

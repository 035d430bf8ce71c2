"""Every command is a function of the same arguments, and its help explains them."""

import importlib
import inspect
import pkgutil
import subprocess
import sys
from enum import Enum
from typing import Any

import pytest
import typer

import physgnn
from physgnn import stages
from physgnn.cli.app import app
from physgnn.stages.naming import CALLBACKS, COMMANDS, OPTIONS

GROUP: Any = typer.main.get_command(app)


def options(name: str) -> dict[str, Any]:
    """The command's parameters by the names of the function's arguments."""
    found = {}
    for parameter in GROUP.commands[name].params:
        long = next((o for o in parameter.opts if o.startswith("--")), parameter.name)
        word = long.removeprefix("--").replace("-", "_")
        if word != "help":
            found[OPTIONS.get(word, word)] = parameter
    return found


def plain(value: Any) -> Any:
    """A default as both sides write it: nothing repeated is None here and () there."""
    value = value.value if isinstance(value, Enum) else value
    return None if value is inspect.Parameter.empty or value == () else value


def test_every_command_has_a_function_and_every_function_a_command() -> None:
    assert set(COMMANDS) == set(GROUP.commands)
    assert set(stages.__all__) == set(COMMANDS.values())


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_a_command_has_the_arguments_of_its_function(name: str) -> None:
    function = getattr(stages, COMMANDS[name])
    arguments = inspect.signature(function).parameters
    told = options(name)
    assert set(told) == set(arguments) - CALLBACKS
    for argument, parameter in told.items():
        default = plain(arguments[argument].default)
        required = arguments[argument].default is inspect.Parameter.empty
        # of two arguments in a row the first can only be left out if both can
        either = name == "adapt" and argument in ("run", "case")
        assert required == parameter.required or argument == "run" or either, argument
        given = (
            parameter.default() if callable(parameter.default) else parameter.default
        )
        assert str(plain(given)) == str(default), argument
    for word in arguments:
        assert f"{word}" in (inspect.getdoc(function) or ""), (
            f"{word} is not documented"
        )


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_a_command_is_reachable_from_the_package(name: str) -> None:
    for module in pkgutil.iter_modules(physgnn.__path__):
        importlib.import_module(f"physgnn.{module.name}")  # none may hide a function
    function = getattr(physgnn, COMMANDS[name])
    assert inspect.isfunction(function)
    assert function is getattr(stages, COMMANDS[name])
    assert COMMANDS[name] in physgnn.__all__


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_help_is_whole_sentences(name: str) -> None:
    command = GROUP.commands[name]
    for parameter in command.params:
        if parameter.name == "help":
            continue
        text = getattr(parameter, "help", None)
        assert text, parameter.name
        assert text[0].isupper() and text.endswith("."), (parameter.name, text)
        assert len(text.split()) >= 3, (parameter.name, text)


def test_names_that_the_help_spells_out_are_those_of_the_tables() -> None:
    from physgnn.evaluation.measure.baselines import baseline_names
    from physgnn.geometry.segmentation.labels.label_tables import LABEL_TABLES
    from physgnn.io.displacement_files import FORMS
    from physgnn.learning.models import MODELS

    for command, option, rows in (
        ("train", "model", MODELS),
        ("evaluate", "baselines", baseline_names()),
        ("mesh", "labels", LABEL_TABLES),
        ("predict", "form", FORMS),
    ):
        text = options(command)[option].help
        for row in rows:
            assert row in text, (command, option, row)


def test_help_comes_without_torch_or_kernels() -> None:
    code = (
        "import sys; from physgnn.cli.app import app; sys.argv = ['physgnn', {0}]\n"
        "try: app()\n"
        "except SystemExit: pass\n"
        "heavy = {{'torch', 'numba', 'numpy', 'pyvista', 'dask'}} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    for words in ("'--help'", "'train', '--help'", "'simulate', '--help'"):
        done = subprocess.run(
            [sys.executable, "-c", code.format(words)], capture_output=True, check=False
        )
        assert done.returncode == 0, done.stderr.decode()

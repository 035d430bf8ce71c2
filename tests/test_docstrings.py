"""Every public function says what it takes, gives and raises, in numpydoc's sections.

Public is what ``physgnn`` and its rooms export. What is checked is that each parameter
is named, that what is returned has a section, and that InputError is announced by a
function that raises it itself.
"""

import importlib
import inspect
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import physgnn

ROOMS = (
    "geometry",
    "mechanics",
    "io",
    "imaging",
    "dataset",
    "prediction",
    "evaluation",
    "serving",
    "config",
)
SECTION = re.compile(r"^([A-Z][A-Za-z ]+)\n-{3,}$", re.MULTILINE)


def sections(text: str) -> dict[str, str]:
    """Return the sections of a numpydoc docstring, the summary under no name."""
    parts = SECTION.split(inspect.cleandoc(text))
    return {"": parts[0]} | dict(zip(parts[1::2], parts[2::2], strict=True))


def documented(section: str) -> set[str]:
    """Return the names that a section describes."""
    heads = re.findall(r"^(\*{0,2}\w[^:\n]*?)(?: *:.*)?$", section, re.MULTILINE)
    return {name.strip().lstrip("*") for head in heads for name in head.split(",")}


def exported() -> Iterator[tuple[str, Any]]:
    for name in physgnn.__all__:
        yield name, getattr(physgnn, name)
    for room in ROOMS:
        module = importlib.import_module(f"physgnn.{room}")
        for name in module.__all__:
            yield f"{room}.{name}", getattr(module, name)


FUNCTIONS = {
    name: thing
    for name, thing in exported()
    if inspect.isfunction(inspect.unwrap(thing))
}
CLASSES = {name: thing for name, thing in exported() if inspect.isclass(thing)}


def parameters(function: Callable[..., Any]) -> set[str]:
    return set(inspect.signature(function).parameters) - {"self"}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_names_its_parameters_and_what_it_returns(name: str) -> None:
    function = FUNCTIONS[name]
    found = sections(function.__doc__ or "")
    missing = parameters(function) - documented(found.get("Parameters", ""))
    assert not missing, f"no word on {sorted(missing)}"
    gives = inspect.signature(function).return_annotation
    if gives not in (None, "None"):
        assert found.keys() & {"Returns", "Yields"}, (
            f"no word on the {gives} it returns"
        )


@pytest.mark.parametrize("name", CLASSES)
def test_a_class_names_what_it_is_made_of(name: str) -> None:
    kind = CLASSES[name]
    found = sections(kind.__doc__ or "")
    assert found[""].strip(), "says nothing"
    if issubclass(kind, BaseException) or getattr(kind, "_is_protocol", False):
        return
    if hasattr(kind, "__members__"):  # an enum
        return
    made_of = parameters(kind.__init__) - {"args", "kwargs"}
    text = found.get("Parameters", "") + "\n" + found.get("Attributes", "")
    missing = made_of - documented(text)
    assert not missing, f"no word on {sorted(missing)}"


@pytest.mark.parametrize("name", FUNCTIONS)
def test_what_is_raised_is_said(name: str) -> None:
    function = inspect.unwrap(FUNCTIONS[name])
    if re.search(r"^    .*raise InputError", inspect.getsource(function), re.MULTILINE):
        text = function.__doc__ or ""
        assert "InputError" in text, "raises InputError, and does not say so"

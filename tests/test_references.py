"""What docstrings and documents name in backticks is there.

A dotted name that begins with the package's is imported and looked up. In a docstring a
class or a table in single backticks (`Solver`, `Predictor.load`, `SPLITS`), which the
reference turns into a link, must be found from where it stands: in its module, its
class, or the packages around them.
"""

import ast
import importlib
import inspect
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import physgnn

PACKAGE = Path(physgnn.__file__).parent
ROOT = Path(__file__).parents[1]
SOURCES = sorted(PACKAGE.rglob("*.py"))
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
NAME = re.compile(r"`{1,2}[~.]?(physgnn(?:\.\w+)+)(?:\(\))?`{1,2}")
LINK = re.compile(r"(?<!`)`~?([A-Z]\w+(?:\.\w+)*)(?:\(\))?`(?!`)")


@cache
def resolve(name: str) -> Any:
    """Import as much of a dotted name as is a module, and look the rest up."""
    parts = name.split(".")
    for end in range(len(parts), 0, -1):
        try:
            found: Any = importlib.import_module(".".join(parts[:end]))
        except ModuleNotFoundError:
            continue
        return lookup(found, parts[end:])
    raise LookupError(name)


def lookup(found: Any, parts: list[str]) -> Any:
    for part in parts:
        fields = getattr(found, "__dataclass_fields__", {})
        found = fields[part] if part in fields else getattr(found, part)
    return found


def docstrings(source: Path) -> list[tuple[tuple[str, ...], str]]:
    """The docstrings of a file, each with the names of what it stands in."""
    found: list[tuple[tuple[str, ...], str]] = []

    def visit(node: ast.AST, inside: tuple[str, ...]) -> None:
        for child in ast.iter_child_nodes(node):
            deeper = inside
            if isinstance(child, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                deeper = (*inside, child.name)
            is_text = isinstance(child, ast.Expr) and isinstance(
                child.value, ast.Constant
            )
            if is_text and isinstance(child.value.value, str):  # type: ignore[attr-defined]
                found.append((inside, child.value.value))  # type: ignore[attr-defined]
            visit(child, deeper)

    visit(ast.parse(source.read_text("utf-8")), ())
    return found


def module_of(source: Path) -> str:
    parts = source.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def is_there(name: str, module: str, inside: tuple[str, ...]) -> bool:
    """Whether a name is found from where it stands, as a reader would look for it."""
    scopes = [(module, inside[:n]) for n in range(len(inside), -1, -1)]
    packages = module.split(".")
    scopes += [(".".join(packages[:n]), ()) for n in range(len(packages) - 1, 0, -1)]
    for where, classes in scopes:
        try:
            found = lookup(importlib.import_module(where), list(classes))
        except AttributeError:  # within a function
            continue
        if classes and inspect.isfunction(found):
            if name in inspect.signature(found).parameters:
                return True
            continue
        try:
            lookup(found, name.split("."))
        except (AttributeError, KeyError):
            pass
        else:
            return True
        if inspect.isclass(found) and name in inspect.signature(found).parameters:
            return True
    try:
        resolve(f"{'.'.join(packages[:2])}.{name}")
    except (LookupError, AttributeError):
        return False
    return True


def test_resolve_finds_what_is_there_and_only_that() -> None:
    assert resolve("physgnn.learning.runs.folder.RunFolder.record")
    assert resolve("physgnn.simulate") is physgnn.simulate
    for name in ("physgnn.learning.train", "physgnn.no_such", "physgnn.Store.no"):
        with pytest.raises((AttributeError, LookupError)):
            resolve(name)


@pytest.mark.parametrize(
    "file", [*SOURCES, *DOCUMENTS], ids=lambda file: str(file.relative_to(ROOT))
)
def test_full_names_are_there(file: Path) -> None:
    missing = []
    for name in set(NAME.findall(file.read_text("utf-8"))):
        try:
            resolve(name)
        except (AttributeError, LookupError):
            missing.append(name)
    assert not missing, f"{file.relative_to(ROOT)} names what is not there: {missing}"


@pytest.mark.parametrize("file", SOURCES, ids=lambda file: str(file.relative_to(ROOT)))
def test_links_in_docstrings_lead_somewhere(file: Path) -> None:
    missing = [
        (".".join(inside), name)
        for inside, text in docstrings(file)
        for name in LINK.findall(text)
        if not is_there(name, module_of(file), inside)
    ]
    assert not missing, f"{file.relative_to(ROOT)}: {missing}"

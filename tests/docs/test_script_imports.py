"""Scripts that no test runs still name what the package has: a rename reaches them."""

import ast
import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPTS = sorted(
    script
    for folder in ("benchmarks", "docs", "examples", "tests/faults")
    for script in (ROOT / folder).rglob("*.py")
)


def names_taken(script: Path) -> list[tuple[str, str]]:
    """Return (module, name) of whatever a script takes from the package."""
    tree = ast.parse(script.read_text("utf-8"))
    return [
        (node.module, name.name)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        and str(node.module).split(".")[0] == "physgnn"
        for name in node.names
    ]


@pytest.mark.parametrize(
    "script", SCRIPTS, ids=lambda path: path.relative_to(ROOT).as_posix()
)
def test_what_a_script_imports_exists(script: Path) -> None:
    for module, name in names_taken(script):
        there = hasattr(importlib.import_module(module), name)
        if not there:  # a module of the package, not yet imported
            importlib.import_module(f"{module}.{name}")

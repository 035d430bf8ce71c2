"""A name means one thing: no two classes share one, no function hides its module."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import physgnn

SOURCE = Path(physgnn.__file__).parent

# What is still to be renamed. A line goes when its fault is mended; none may be added.
SHARED: set[str] = set()
SHADOWED: set[str] = set()


def modules() -> Iterator[tuple[str, ast.Module]]:
    for file in sorted(SOURCE.rglob("*.py")):
        yield (
            file.relative_to(SOURCE).as_posix(),
            ast.parse(file.read_text("utf-8"), str(file)),
        )


def types_of(module: ast.Module) -> Iterator[tuple[str, bool]]:
    """Yield the public types of a module, and whether each is a class or an alias."""
    for node in module.body:
        if isinstance(node, ast.ClassDef):
            yield node.name, True
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            name = node.targets[0].id
            if name[0].isupper() and not name.isupper():
                yield name, False


def test_no_class_shares_its_name_with_another_type() -> None:
    where: dict[str, list[str]] = defaultdict(list)
    classes: set[str] = set()
    for path, module in modules():
        for name, is_class in types_of(module):
            where[name].append(path)
            classes |= {name} if is_class else set()
    shared = {name: where[name] for name in classes if len(where[name]) > 1}
    assert shared.keys() <= SHARED, f"rename all but one: {shared}"
    assert shared.keys() >= SHARED, "mended: take it off the list"


def test_no_public_function_is_named_like_its_module() -> None:
    shadowed = {
        path
        for path, module in modules()
        for node in module.body
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        if node.name == Path(path).stem
    }
    assert shadowed <= SHADOWED, f"rename the module: {shadowed - SHADOWED}"
    assert shadowed >= SHADOWED, f"mended: {SHADOWED - shadowed} goes from the list"

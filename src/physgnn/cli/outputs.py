"""No command writes over what it reads: asked of all alike, before any work."""

import inspect
from collections.abc import Callable, Iterator, Mapping
from functools import wraps
from pathlib import Path
from typing import Any

from physgnn.errors import InputError

WRITTEN = frozenset({
    "arrays", "chart", "febio", "field", "folder", "jacobian", "misfits", "onnx", "out",
    "picture", "report", "save", "slices", "wrong",
})  # fmt: skip
"""Arguments that name what a command writes; every other path is read."""


def guarded(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command that refuses outputs which are inputs, or each other.

    Parameters
    ----------
    command : callable
        Takes its paths by keyword, as the command line calls it.
    """

    @wraps(command)
    def run(*args: Any, **options: Any) -> None:
        given = inspect.signature(command).bind(*args, **options).arguments
        check_apart(given)
        command(*args, **options)

    return run


def check_apart(given: Mapping[str, Any]) -> None:
    """Raise InputError if a path to be written is one that is read, or another output.

    Links are followed, so that a file cannot be named in two ways.

    Parameters
    ----------
    given : mapping
        From an argument's name to its value.
    """
    taken = {
        path.resolve(): name
        for name, path in _paths(given)
        if name not in WRITTEN and path.exists()
    }
    for name, path in _paths(given):
        if name not in WRITTEN:
            continue
        place = path.resolve()
        if place in taken:
            raise InputError(
                f"--{name.replace('_', '-')} {path} would be written over "
                f"{taken[place].replace('_', ' ')}, the same file: name another"
            )
        taken[place] = f"--{name}"


def _paths(given: Mapping[str, Any]) -> Iterator[tuple[str, Path]]:
    for name, value in given.items():
        for one in value if isinstance(value, list | tuple) else [value]:
            if isinstance(one, Path):
                yield name, one

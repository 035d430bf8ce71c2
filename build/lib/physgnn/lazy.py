"""Names of a package that are imported when they are first asked for.

The package's stub, ``__init__.pyi``, is the table of them: type checkers read it, and
so does this module. One row there exports a name.
"""

import ast
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

EVERYTHING = "*"


def attach(package: str, file: str) -> tuple[Callable[[str], Any], list[str]]:
    """Return a package's ``__getattr__`` and ``__all__``, as its stub has them.

    Parameters
    ----------
    package : str
        The package's ``__name__``.
    file : str
        Its ``__file__``, beside which the stub lies.

    Returns
    -------
    getattr : callable
        From a name to what it stands for. The name's module is imported only then.
    names : list of str
        The names in alphabetical order.
    """
    homes = _homes(package, Path(file).with_suffix(".pyi"))

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        return getattr(import_module(homes[name]), name)

    return get, sorted(homes)


def _homes(package: str, stub: Path) -> dict[str, str]:
    """Return name → module of a stub's relative imports; ``*`` is a package's stub."""
    homes: dict[str, str] = {}
    for row in ast.parse(stub.read_text(encoding="utf-8")).body:
        if not (isinstance(row, ast.ImportFrom) and row.level):
            continue
        module = f"{package}.{row.module}"
        for name in (alias.name for alias in row.names):
            if name == EVERYTHING:
                folder = stub.parent.joinpath(*str(row.module).split("."))
                homes |= _homes(module, folder / stub.name)
            else:
                homes[name] = module
    return homes

"""TOML tables to dataclasses, keys and types checked."""

import tomllib
from collections.abc import Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

from physgnn.errors import InputError

T = TypeVar("T")


def read_toml(path: str | Path) -> dict[str, Any]:
    """Return the tables of a TOML file; InputError says where it is broken."""
    try:
        return tomllib.loads(Path(path).read_text("utf-8"))
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}") from error
    except ValueError as error:  # TOML or UTF-8
        raise InputError(f"{path} is not a TOML file: {error}") from error


def from_table(cls: type[T], table: Any, where: str) -> T:
    """Make a dataclass of a table, its keys and the types of its values checked.

    Raises
    ------
    InputError
        If a key is unknown or missing, or a value has another type.
    """
    if not isinstance(table, Mapping):
        raise InputError(f"{where} must be a table (got {table!r})")
    known = fields(cls)  # type: ignore[arg-type]
    check_keys(table, [field.name for field in known], where)
    for field in known:
        required = field.default is MISSING and field.default_factory is MISSING
        if required and field.name not in table:
            raise InputError(f"{where} needs the key '{field.name}'")
    types = get_type_hints(cls)
    for name, value in table.items():
        _check_type(name, value, types[name], where)
    return cls(**table)


def check_keys(table: Mapping[str, Any], allowed: Any, where: str) -> None:
    """Raise InputError for the first key that is not among those allowed."""
    for key in table:
        if key not in allowed:
            raise InputError(
                f"unknown key '{key}' in {where} (its keys: {', '.join(allowed)})"
            )


def named(table: Any, key: str, rows: Mapping[str, T], where: str) -> T:
    """Return the row of a table of variants that a TOML table's key names.

    Raises
    ------
    InputError
        If it is no table, or names no row.
    """
    name = table.get(key) if isinstance(table, Mapping) else table
    if not isinstance(name, str) or name not in rows:
        raise InputError(
            f"{where} needs {key} = one of {', '.join(rows)} (got {name!r})"
        )
    return rows[name]


def _check_type(name: str, value: Any, expected: Any, where: str) -> None:
    if get_origin(expected) is tuple:
        _check_numbers(name, value, get_args(expected), where)
        return
    union = get_origin(expected) in (Union, UnionType)
    choices = get_args(expected) if union else (expected,)
    scalars = tuple(choice for choice in choices if choice in (int, float, str, bool))
    if not scalars:
        return
    accepted = (*scalars, *((int,) if float in scalars else ()))
    wrong_bool = isinstance(value, bool) and bool not in scalars
    optional = value is None and NoneType in choices
    if not optional and (wrong_bool or not isinstance(value, accepted)):
        words = " or ".join(choice.__name__ for choice in scalars)
        raise InputError(f"{name} in {where} must be {words} (got {value!r})")


def _check_numbers(name: str, value: Any, types: tuple[Any, ...], where: str) -> None:
    """Check a list of numbers: as many as there are types, or any number."""
    fits = isinstance(value, list | tuple) and (
        Ellipsis in types or len(value) == len(types)
    )
    if fits and all(type(item) in (int, float) for item in value):
        return
    many = "" if Ellipsis in types else f"{len(types)} "
    raise InputError(
        f"{name} in {where} must be a list of {many}numbers (got {value!r})"
    )

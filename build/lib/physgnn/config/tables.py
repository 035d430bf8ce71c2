"""TOML tables to checked values, by pydantic; every mistake is one line.

A dataclass that stands in a file is described by its own fields (`table_of`). Where a
key of a table names the class that the others belong to, as ``kind`` does of a load,
the classes are the rows of a table (`variants`).
"""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from difflib import get_close_matches
from pathlib import Path
from typing import (
    Annotated,
    Any,
    Literal,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Tag,
    TypeAdapter,
    ValidationError,
    WrapValidator,
    create_model,
    model_validator,
)
from pydantic_core import ErrorDetails, PydanticCustomError

from physgnn.errors import InputError
from physgnn.io.untrusted.text import read_toml_text

T = TypeVar("T")
Place = tuple[str | int, ...]
"""The keys and numbers that lead to a table of a file."""

TAG = "="  # begins what a place holds of the row chosen, which no user wrote
WORDS = {
    "int_type": "int",
    "float_type": "float",
    "string_type": "str",
    "bool_type": "bool",
    "finite_number": "a finite number",
    "dict_type": "a table",
    "mapping_type": "a table",
    "model_type": "a table",
    "tuple_type": "a list of tables",
}


class ConfigTable(BaseModel):
    """A TOML table: its keys are known, its values are what they look like."""

    model_config = ConfigDict(
        extra="forbid", strict=True, frozen=True, allow_inf_nan=False
    )

    @model_validator(mode="before")
    @classmethod
    def _has_known_keys(cls, table: Any) -> Any:
        known = list(cls.model_fields)
        for key in table if isinstance(table, Mapping) else ():
            if key not in known:
                near = "".join(
                    f", did you mean '{word}'?"
                    for word in get_close_matches(key, known, 1)
                )
                words = {"key": key, "near": near, "known": ", ".join(known)}
                raise PydanticCustomError("unknown_key", "{key}", words)
        return table


def read_toml(path: str | Path) -> dict[str, Any]:
    """Return the tables of a TOML file; InputError says where it is broken.

    Parameters
    ----------
    path : path
        The TOML file.

    Returns
    -------
    dict
        The tables, by name.
    """
    return read_toml_text(path)


def read_as(kind: Any, table: Any, file: str | Path, *, at: Place = ()) -> Any:
    """Return what a table of a file says.

    Parameters
    ----------
    kind : type
        A `ConfigTable`, or any other type that pydantic knows.
    table : any
        The table, as `read_toml` returns it.
    file : path
        For the message.
    at : tuple
        Where in the file the table stands.

    Returns
    -------
    any
        What `kind` makes of it.

    Raises
    ------
    InputError
        If a key is unknown or missing, or a value is wrong: the first that is.
    """
    try:
        return TypeAdapter(kind).validate_python(_with_tuples(table))
    except ValidationError as error:
        found = error.errors()
        first = next((e for e in found if e["type"] == "unknown_key"), found[0])
        raise InputError(_line(first, str(file), at)) from error


def table_of(cls: type[T], *, types: Mapping[Any, Any] | None = None) -> Any:
    """Return the pydantic type of a table that holds the fields of a dataclass.

    Parameters
    ----------
    cls : type
        The dataclass; what it refuses when made is a mistake in the table.
    types : mapping, optional
        What stands in the table for a field of another type.
    """
    model = _model(cls, {}, types or {})
    return Annotated[model, AfterValidator(_maker(cls))]


def variants(
    key: str,
    rows: Mapping[str, type[T]],
    *,
    default: str | None = None,
    types: Mapping[Any, Any] | None = None,
) -> Any:
    """Return the pydantic type of a table whose `key` names a row.

    Parameters
    ----------
    key : str
        Such as ``kind``.
    rows : mapping of str to dataclass
        What there is to choose from.
    default : str, optional
        The row that is meant where the key is left out.
    types : mapping, optional
        As of `table_of`.
    """

    def chosen(table: Any) -> str | None:
        name = table.get(key, default) if isinstance(table, Mapping) else None
        return f"{TAG}{name}"

    kinds = [
        Annotated[
            _model(cls, {key: (Literal[name], name)}, types or {}),
            AfterValidator(_maker(cls)),
            Tag(f"{TAG}{name}"),
        ]
        for name, cls in rows.items()
    ]
    needs = f"needs {key} = one of {', '.join(rows)}"
    by_key = Discriminator(
        chosen, custom_error_type="variant", custom_error_message=needs
    )
    return Annotated[Union[tuple(kinds)], by_key]  # noqa: UP007


def _model(
    cls: type, more: Mapping[str, Any], types: Mapping[Any, Any]
) -> type[BaseModel]:
    hints = get_type_hints(cls)
    columns = dict(more)
    for field in fields(cls):
        hint = types.get(hints[field.name], _numbers(hints[field.name]))
        columns[field.name] = (hint, _default(field))
    return create_model(cls.__name__, __base__=ConfigTable, **columns)


def _default(field: Any) -> Any:
    if field.default is not MISSING:
        return field.default
    return ... if field.default_factory is MISSING else field.default_factory()


def _maker(cls: type[T]) -> Callable[[BaseModel], T]:
    names = [field.name for field in fields(cls)]  # type: ignore[arg-type]
    return lambda model: cls(**{name: getattr(model, name) for name in names})


def _numbers(hint: Any) -> Any:
    """Return a type whose mistakes are reported of the list, not of its items."""
    kinds = get_args(hint)
    if get_origin(hint) is not tuple or {*kinds} - {float, ...}:
        return hint
    many = "" if Ellipsis in kinds else f"{len(kinds)} "

    def check(value: Any, whole: Callable[[Any], Any]) -> Any:
        try:
            return whole(value)
        except ValidationError as error:
            kinds_of_error = {e["type"] for e in error.errors()}
            finite = "finite " if "finite_number" in kinds_of_error else ""
            words = f"a list of {many}{finite}numbers"
            raise PydanticCustomError("numbers", "{w}", {"w": words}) from error

    return Annotated[hint, WrapValidator(check)]


def _with_tuples(value: Any) -> Any:
    """Return a TOML value with tuples for lists: pydantic takes neither for both."""
    if isinstance(value, list):
        return tuple(_with_tuples(item) for item in value)
    if isinstance(value, Mapping):
        return {key: _with_tuples(item) for key, item in value.items()}
    return value


def _line(error: ErrorDetails, file: str, at: Place) -> str:
    """Say in one line what was expected, what came, and where."""
    ctx = error.get("ctx", {})
    loc = [*at, *(k for k in error["loc"] if not str(k).startswith(TAG))]
    here, key = _words(loc, file), str(loc[-1]) if loc else ""
    got = f"(got {_shown(error['input'])})"
    inside = _words(loc[:-1], file)
    of_value = f"{key} in {inside}" if key and isinstance(loc[-1], str) else here
    match error["type"]:
        case "unknown_key":
            unknown = f"unknown key '{ctx['key']}' in {here}{ctx['near']}"
            return f"{unknown} (its keys: {ctx['known']})"
        case "missing":
            return f"{inside} needs the key '{key}'"
        case "lacks_key":
            return f"{here} needs the key '{ctx['key']}'"
        case "variant":
            return f"{here} {error['msg']} {got}"
        case "numbers":
            return f"{of_value} must be {error['msg']} {got}"
        case "literal_error":
            expected = ctx["expected"].replace("'", "").replace(" or ", ", ")
            return f"{of_value} must be one of {expected} {got}"
        case "greater_than":
            return f"{of_value} must be > {ctx['gt']:g} {got}"
        case "greater_than_equal":
            return f"{of_value} must be ≥ {ctx['ge']:g} {got}"
        case "value_error":
            return f"{here}: {ctx['error']}"
        case "model_type" | "dict_type" | "mapping_type":
            return f"{here} must be a table {got}"
        case kind:
            return f"{of_value} must be {WORDS.get(kind, error['msg'])} {got}"


def _words(place: list[Any] | Place, file: str) -> str:
    """Return where a table stands, as its head in the file is written."""
    names = ".".join(k for k in place if isinstance(k, str))
    numbers = [k for k in place if isinstance(k, int)]
    if not names:
        return file
    head = f"[[{names}]] number {numbers[0] + 1}" if numbers else f"[{names}]"
    return f"{head} in {file}"


def _shown(value: Any) -> str:
    return repr(list(value) if isinstance(value, tuple) else value)

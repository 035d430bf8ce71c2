"""The columns of a table of patients, read off the functions of the stages.

Every argument of a step is a column: ``register.noise_mm``, or ``noise_mm`` where no
other step has one of that name. Dashes do for underscores, as on the command line.
"""

import inspect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args, get_origin

from pydantic import TypeAdapter, ValidationError

from physgnn import stages
from physgnn.errors import InputError
from physgnn.stages.cohort.step_table import Step
from physgnn.stages.naming import CALLBACKS

NAME = "name"
CASE = "case"
"""A column of no step alone: a mesh that is there already."""
MEANT = {"image": "warp.image"}
"""Short names that several steps have, and which is meant."""
SEPARATOR = "|"


@dataclass(frozen=True)
class OptionColumn:
    """An argument of a step.

    Attributes
    ----------
    step, argument : str
    annotation : type
        Of the argument.
    """

    step: str
    argument: str
    annotation: Any

    @property
    def name(self) -> str:
        """In full."""
        return f"{self.step}.{self.argument}"

    @property
    def is_many(self) -> bool:
        """Whether a cell may hold several values."""
        return get_origin(self.annotation) is Sequence

    @property
    def is_path(self) -> bool:
        """Whether it names files or folders."""
        kinds = get_args(self.annotation)
        return any(kind is Path or Path in get_args(kind) for kind in kinds)

    def value(self, text: str, folder: Path) -> Any:
        """Return what a cell means; paths start from a folder.

        Raises
        ------
        InputError
            If it is no value of the argument.
        """
        if self.is_path:
            paths = [folder / part.strip() for part in text.split(SEPARATOR)]
            for path in paths:
                if not path.exists() and not self._is_name(path.name):
                    raise InputError(f"{self.name}: there is no {path}")
            named = [path.name if not path.exists() else str(path) for path in paths]
            return named if self.is_many else self._one(named)
        try:
            return TypeAdapter(self.annotation).validate_python(text)
        except ValidationError as error:
            kind = getattr(self.annotation, "__name__", self.annotation)
            raise InputError(
                f"column {self.name} must be {kind} (got '{text}')"
            ) from error

    def _one(self, named: list[str]) -> str:
        if len(named) > 1:
            raise InputError(f"column {self.name} takes one file (got {len(named)})")
        return named[0]

    def _is_name(self, text: str) -> bool:
        from physgnn.bundled import FAMILY_NAME

        return self.argument == "run" and text == FAMILY_NAME


def columns_of(steps: Sequence[Step]) -> Mapping[str, OptionColumn]:
    """Return every column by each of its names."""
    full = [column for step in steps for column in _of_step(step)]
    short = [column.argument for column in full]
    named = {column.name: column for column in full}
    alone = {c.argument: c for c in full if short.count(c.argument) == 1}
    meant = {name: named[of] for name, of in MEANT.items() if of in named}
    return {**named, **alone, **meant}


def _of_step(step: Step) -> list[OptionColumn]:
    function = getattr(stages, step.command)
    arguments = inspect.signature(function).parameters
    # what it writes is the batch's to name: a cell could name another patient's file
    own = {"out", *CALLBACKS, *step.writes, *getattr(function, "outputs", ())}
    return [
        OptionColumn(step.command, name, parameter.annotation)
        for name, parameter in arguments.items()
        if name not in own
    ]


def find_column(name: str, columns: Mapping[str, OptionColumn]) -> OptionColumn:
    """Return a column by name.

    Raises
    ------
    InputError
        If there is none, or the name is of several.
    """
    plain = name.strip().lower().replace("-", "_")
    if plain in columns:
        return columns[plain]
    of = sorted({c.name for c in columns.values() if c.argument == plain})
    if of:
        raise InputError(f"column '{name}' may be {' or '.join(of)}: name it in full")
    known = ", ".join(sorted({n for n in columns if "." not in n} - {NAME, CASE}))
    raise InputError(
        f"unknown column '{name}' (there are: {NAME}, {CASE}, {known}; and each in "
        "full, as register.noise_mm)"
    )

"""Which steps a patient's cells ask for, and what each is called with."""

import inspect
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from physgnn import stages
from physgnn.errors import InputError
from physgnn.stages.cohort.columns import CASE, OptionColumn, columns_of
from physgnn.stages.cohort.patient_table import Patient
from physgnn.stages.cohort.step_table import Step, steps
from physgnn.stages.option_rules import check_options


@dataclass(frozen=True)
class Call:
    """A step to do.

    Attributes
    ----------
    step : Step
    arguments : mapping
        Of its function, but for what it writes.
    written : mapping
        The arguments that name what it writes, ``out`` among them.
    inputs : tuple of Path
        Files and folders that the result depends on.
    made : Path
        What later steps take.
    resumes : bool
        Whether the function itself knows what of it is done.
    """

    step: Step
    arguments: Mapping[str, Any]
    written: Mapping[str, Any]
    inputs: tuple[Path, ...]
    made: Path
    resumes: bool = False

    @property
    def out(self) -> Path:
        """Where its result goes."""
        return Path(self.written["out"])

    @property
    def files(self) -> list[Path]:
        """All that it writes."""
        values = [v for v in self.written.values() if v is not None]
        return [file for v in values for file in (v if isinstance(v, list) else [v])]


class StepError(InputError):
    """What is wrong with a patient, and in which step."""

    def __init__(self, step: str, reason: str) -> None:
        super().__init__(reason)
        self.step = step


def plan(patient: Patient, tables: Path, folder: Path) -> list[Call]:
    """Return what there is to do for a patient.

    Parameters
    ----------
    patient : Patient
    tables : Path
        Folder that paths in cells start from.
    folder : Path
        The patient's own.

    Raises
    ------
    StepError
        If cells cannot be used, or ask for nothing.
    """
    columns = columns_of(steps())
    there: dict[str, Path] = {}
    if CASE in patient.cells:
        there[CASE] = tables / patient.cells[CASE]
        if not there[CASE].is_file():
            raise StepError("mesh", f"case: there is no {there[CASE]}")
    calls: list[Call] = []
    for step in steps():
        own = {
            columns[name].argument: (columns[name], cell)
            for name, cell in patient.cells.items()
            if name.startswith(f"{step.command}.")
        }
        try:
            call = _call(step, own, there, tables, folder)
        except InputError as error:
            raise StepError(step.command, str(error)) from error
        if call is not None:
            calls.append(call)
            there[step.makes] = call.made
    if not calls:
        asked = ", ".join(f"{s.command}.{s.starts[0]}" for s in steps())
        has = ", ".join(patient.cells) or "no cell"
        raise StepError(
            "",
            f"its line asks for nothing ({has} is filled in): fill in such as {asked}",
        )
    return calls


def _call(
    step: Step,
    own: Mapping[str, tuple[OptionColumn, str]],
    there: Mapping[str, Path],
    tables: Path,
    folder: Path,
) -> Call | None:
    """Return a step's call; None if nothing asks for it."""
    values = {name: column.value(cell, tables) for name, (column, cell) in own.items()}
    paths = [
        Path(path)
        for name, (column, _) in own.items()
        if column.is_path
        for path in (values[name] if column.is_many else [values[name]])
        if Path(path).exists()
    ]
    made = {
        name: there[what]
        for name, what in step.takes.items()
        if name not in values and what in there
    }
    given = {**values, **made}
    if not any(given.get(name, False) is not False for name in step.starts):
        if own:
            names = ", ".join(column.name for column, _ in own.values())
            raise InputError(
                f"{names} alone asks for nothing: fill in {_columns_of(step)} too"
            )
        return None
    if step.makes in there:
        raise InputError(
            f"makes {there[step.makes].name}, which another column gives or makes "
            "already: leave one of them empty"
        )
    if step.of_mesh and step.of_mesh not in given and CASE in there:
        raise InputError(
            "the patient's mesh has no network: fill in adapt.loads, which makes a "
            f"family's ready for it, or {step.command}.{step.of_mesh}"
        )
    filled = [name for name, value in given.items() if value is not False]
    check_options(step.command, filled, lambda name: f"{step.command}.{name}")
    given = {**step.defaults, **given}
    for name in _required(step):
        if name not in given:
            raise InputError(f"nothing gives its {name}: {_who_makes(step, name)}")
    several = step.several
    if several is not None and several.argument not in given:
        several = None
    out = folder / (step.file if several is None else several.folder)
    return Call(
        step,
        given,
        {"out": out, **(_beside(step, folder) if several is None else {})},
        (*paths, *made.values()),
        made=out if several is None else out / several.last(given),
        resumes=several is not None,
    )


def _beside(step: Step, folder: Path) -> dict[str, Any]:
    """Return the arguments that name what a step writes beside its result."""
    told = _signature(step)
    return {
        name: value
        if value is None
        else [folder / one for one in value]
        if isinstance(value, list)
        else folder / value
        for name, value in step.writes.items()
        if name in told
    }


def _columns_of(step: Step) -> str:
    arguments = _signature(step)
    names = [f"{step.command}.{name}" for name in step.starts if name in arguments]
    return " or ".join(names)


def _who_makes(step: Step, argument: str) -> str:
    what = step.takes.get(argument)
    by = [row for row in steps() if row.makes == what]
    columns = [f"{step.command}.{argument}", *(_columns_of(row) for row in by)]
    return f"fill in {' or '.join(columns)}"


def _required(step: Step) -> list[str]:
    empty = inspect.Parameter.empty
    arguments = _signature(step)
    return [n for n, p in arguments.items() if p.default is empty and n != "out"]


def _signature(step: Step) -> Mapping[str, inspect.Parameter]:
    return inspect.signature(getattr(stages, step.command)).parameters

"""A table of the states of an operation: one row each, in order."""

from dataclasses import dataclass, fields, replace
from pathlib import Path

from physgnn.errors import InputError
from physgnn.io.untrusted.csv_table import SAFE_NAME, checked_cells, csv_rows
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.text import read_text
from physgnn.stages.patient.intraoperative.measured_files import BESIDES, MeasuredFiles

NAME, TIME = "name", "time"
ENDS = {"points": "target", "landmarks": "landmarks_target", "bone": "bone_target"}
"""Points before the shift, and those after it where they are a file of their own."""
OF_ONE_STATE = (*ENDS.values(), "surface", "whole_surface", "intraoperative")
"""What is measured anew in every state."""
FILES = tuple(field.name for field in fields(MeasuredFiles))


@dataclass(frozen=True)
class StateRow:
    """A state.

    Attributes
    ----------
    name : str
        Also of its file.
    time : float or None
        In the unit of the table.
    files : MeasuredFiles
        What was measured.
    """

    name: str
    time: float | None
    files: MeasuredFiles


def read_states(path: str | Path, common: MeasuredFiles) -> list[StateRow]:
    """Read a table of states.

    Parameters
    ----------
    path : path
        CSV with the columns name or time, or both, and those of `MeasuredFiles`; paths
        start from its folder.
    common : MeasuredFiles
        What counts in every state whose row does not name another.

    Raises
    ------
    InputError
        If it is no such table, states are out of order, two have one name, a file is
        not there, or a state has nothing measured; with the line.
    """
    for role in OF_ONE_STATE:
        if role in common.paths:
            raise InputError(
                f"--{role.replace('_', '-')} is measured anew in every state of a "
                f"series: name it in a column '{role}' of {Path(path).name}"
            )
    with reading(path, "a table of states"):
        rows = csv_rows(read_text(path))
        if len(rows) < 2:
            raise InputError("expected a header and a line for each state")
        names = _columns(rows.pop(min(rows)))
        folder = Path(path).parent
        states: list[StateRow] = []
        lines: dict[str, int] = {}
        for line, row in rows.items():
            state = _state(line, checked_cells(line, row, names), folder, common)
            same = state.name.lower()  # names differ by case alone on some systems
            if lines.setdefault(same, line) != line:
                raise InputError(
                    f"line {line}: '{state.name}' is the name of line {lines[same]} "
                    "already: give each state its own"
                )
            before = states[-1].time if states else None
            if None not in (before, state.time) and not before < state.time:  # type: ignore[operator]
                raise InputError(
                    f"line {line}: time {state.time:g} comes after {before:g}: put the "
                    "states in the order of time"
                )
            states.append(state)
        return states


def _columns(header: list[str]) -> list[str]:
    names = [cell.lower().replace("-", "_").replace(" ", "_") for cell in header]
    for cell, name in zip(header, names, strict=True):
        if name not in (NAME, TIME, *FILES):
            raise InputError(
                f"unknown column '{cell}' (there are: {NAME}, {TIME}, "
                f"{', '.join(FILES)})"
            )
        if names.count(name) > 1:
            raise InputError(f"column {name} comes {names.count(name)} times")
    if NAME not in names and TIME not in names:
        raise InputError(
            f"expected a column {NAME} or {TIME} (got {', '.join(header)})"
        )
    return names


def _state(
    line: int, cells: dict[str, str], folder: Path, common: MeasuredFiles
) -> StateRow:
    time = _time(line, cells.pop(TIME)) if TIME in cells else None
    name = cells.pop(NAME, "" if time is None else f"time {time:g}")
    if not SAFE_NAME.fullmatch(name):
        raise InputError(
            f"line {line}: a state needs a time, or a name that suits a file: letters, "
            f"digits, space, and . _ + - (got '{name}')"
        )
    own = {role: folder / cell for role, cell in cells.items()}
    for role, file in own.items():
        if not file.exists():
            raise InputError(f"line {line}: {role}: there is no {file}")
    files = replace(common, **own)
    for before, after in ENDS.items():
        if after in files.paths and before not in files.paths:
            raise InputError(
                f"line {line}: '{name}' has {after}, and no {before} to pair with it: "
                "name that too"
            )
        if before in files.paths and not {before, after} & set(own):
            raise InputError(
                f"line {line}: '{name}' has no {before} of its own: what the command "
                f"line names is where they were before, so name {after} here, or "
                f"{before} with both ends"
            )
    if not set(files.paths) - BESIDES:
        raise InputError(
            f"line {line}: '{name}' has nothing measured of the brain: name a file"
        )
    return StateRow(name, time, files)


def _time(line: int, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) < float("inf"):
        raise InputError(f"line {line}: time must be a number (got '{text}')")
    return value

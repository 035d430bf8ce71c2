"""A CSV of patients: rows are patients, columns are options of the stages."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from physgnn.errors import InputError
from physgnn.io.untrusted.csv_table import SAFE_NAME, checked_cells, csv_rows
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.text import read_text
from physgnn.stages.cohort.columns import CASE, NAME, columns_of, find_column
from physgnn.stages.cohort.step_table import steps

RESULTS = "results.csv"


@dataclass(frozen=True)
class Patient:
    """A row.

    Attributes
    ----------
    name : str
        Also of the folder.
    cells : mapping
        Column in full, or ``case``, to what is written there; empty cells are left out.
    """

    name: str
    cells: Mapping[str, str]


def read_patients(path: str | Path) -> list[Patient]:
    """Read a table of patients.

    Parameters
    ----------
    path : path
        CSV with a header; commas, or semicolons or tabs where it has no comma.

    Raises
    ------
    InputError
        If it is no such table: a column is unknown, a name is missing, comes twice or
        can be no folder's; with the line.
    """
    with reading(path, "a table of patients"):
        rows = _rows(read_text(path))
        names = _columns(rows.pop(min(rows)))
        patients = [_patient(line, row, names) for line, row in rows.items()]
        first: dict[str, int] = {}
        for line, patient in zip(rows, patients, strict=True):
            folder = patient.name.lower()  # names differ by case alone on some systems
            if first.setdefault(folder, line) != line:
                raise InputError(
                    f"line {line}: '{patient.name}' is in line {first[folder]} "
                    "already: give each patient a name of its own"
                )
        return patients


def _rows(text: str) -> dict[int, list[str]]:
    """Return the cells of every line that has some, by its number."""
    found = csv_rows(text)
    if len(found) < 2:
        raise InputError("expected a header and a line for each patient")
    return found


def _columns(header: list[str]) -> list[str]:
    """Return the columns in full, ``name`` and ``case`` as they are."""
    known = columns_of(steps())
    names = [
        cell.lower() if cell.lower() in (NAME, CASE) else find_column(cell, known).name
        for cell in header
    ]
    if NAME not in names:
        raise InputError(f"expected a column '{NAME}' (got {', '.join(header)})")
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"column {name} comes {names.count(name)} times")
    return names


def _patient(line: int, row: list[str], names: list[str]) -> Patient:
    cells = checked_cells(line, row, names)
    name = cells.pop(NAME, "")
    if not SAFE_NAME.fullmatch(name) or name.lower() == RESULTS:
        raise InputError(
            f"line {line}: a patient's name must suit a folder: letters, digits, "
            f"space, and . _ + - (got '{name}')"
        )
    return Patient(name, cells)

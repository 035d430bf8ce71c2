"""Reads what a test machine measured: columns of stretch and stress.

With a header (CSV; separated by commas, semicolons, tabs or blanks):

| column | |
|---|---|
| ``tension_stretch``, ``tension_stress_kpa`` | stretch from 1 up, nominal stress |
| ``compression_stretch``, ``compression_stress_kpa`` | from 1 down, negative stress |
| ``shear_amount``, ``shear_stress_kpa`` | amount of shear from 0 up, shear stress |

One pair or more, in any order; ``_pa`` in the place of ``_kpa``, or neither and a unit
from the caller. A curve may end before the others: its cells are empty then.
Lines that begin with ``#`` are comments. Without a
header the six columns stand in this order, as the files of LivingMatterLab/CANN have
them, and the unit is the caller's.
"""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from physgnn.errors import InputError
from physgnn.mechanics.materials.stress_curves import KINDS, SHEAR, StressCurve

PA: Mapping[str, float] = {"kpa": 1e3, "pa": 1.0}
"""Unit of stress → how many Pa."""
USUAL_UNIT = "kpa"
UNIT_ENDINGS = ("", *(f"_{unit}" for unit in PA))
SEPARATORS = ",;\t"
COMMENT = "#"
COLUMNS = {kind: "amount" if kind == SHEAR else "stretch" for kind in KINDS}
Columns = dict[str, list[str]]


def read_stress_curves(
    path: str | Path, *, unit: str | None = None
) -> list[StressCurve]:
    """Read the curves of a file.

    Parameters
    ----------
    path : path
        Text, in UTF-8; see above.
    unit : str, optional
        Of the stresses whose column does not tell: a key of `PA`, by default "kpa".

    Raises
    ------
    InputError
        If the file cannot be read, lacks a column, has one that is not listed above, a
        cell is no number, or a curve is none (`StressCurve`).
    """
    if unit is not None and unit not in PA:
        raise InputError(f"unit must be one of {', '.join(PA)} (got '{unit}')")
    try:
        text = Path(path).read_text("utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except ValueError as error:
        raise InputError(f"{path}: expected text in UTF-8 ({error})") from error
    try:
        columns = _columns(_rows(text))
        if unit is not None and not any(name.endswith("_stress") for name in columns):
            raise InputError("every column names its unit: leave --unit out")
        unit = unit or USUAL_UNIT
        return [_curve(columns, kind, unit) for kind in KINDS if _has(columns, kind)]
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _rows(text: str) -> list[list[str]]:
    lines = [
        line
        for line in text.splitlines()
        if line.strip() and not line.startswith(COMMENT)
    ]
    if not lines:
        raise InputError("expected columns of stretch and stress (the file is empty)")
    found = next((s for s in SEPARATORS if s in lines[0]), None)
    if found is None:
        return [line.split() for line in lines]
    try:
        rows = list(csv.reader(lines, delimiter=found))
    except csv.Error as error:
        raise InputError(f"expected columns of numbers ({error})") from error
    return [[cell.strip() for cell in row] for row in rows]


def _columns(rows: Sequence[Sequence[str]]) -> Columns:
    """Return every column's cells by its name."""
    header = [name.lower() for name in rows[0]]
    first = 1
    if all(_parses(cell) for cell in header):
        header, first = _standard_header(len(header)), 0
    for line, row in enumerate(rows[first:], first + 1):
        if len(row) != len(header):
            raise InputError(
                f"row {line} has {len(row)} cells, and there are {len(header)} columns"
            )
    if len(set(header)) < len(header):
        raise InputError(f"two columns have the same name ({', '.join(header)})")
    _check_names(header)
    return {name: [row[i] for row in rows[first:]] for i, name in enumerate(header)}


def _standard_header(n_columns: int) -> list[str]:
    names = [
        n for kind, x in COLUMNS.items() for n in (f"{kind}_{x}", f"{kind}_stress")
    ]
    if n_columns != len(names):
        raise InputError(
            f"without a header there must be six columns ({', '.join(names)}; got "
            f"{n_columns}): add a header"
        )
    return names


def _check_names(header: Sequence[str]) -> None:
    """Raise InputError if a name is unknown, or one of a pair is missing."""
    known = [f"{kind}_{x}" for kind, x in COLUMNS.items()]
    known += [f"{kind}_stress{ending}" for kind in KINDS for ending in UNIT_ENDINGS]
    for name in header:
        if name not in known:
            raise InputError(f"unknown column '{name}' (there are: {', '.join(known)})")
    for kind, x in COLUMNS.items():
        amounts = [name for name in header if name == f"{kind}_{x}"]
        stresses = [name for name in header if name.startswith(f"{kind}_stress")]
        if len(stresses) > 1:
            raise InputError(f"{kind} has two columns of stress: {', '.join(stresses)}")
        if len(stresses) != len(amounts):
            lacking = f"{kind}_{x}" if stresses else f"{kind}_stress_kpa"
            raise InputError(
                f"column '{lacking}' is missing beside '{(stresses or amounts)[0]}'"
            )


def _has(columns: Columns, kind: str) -> bool:
    return f"{kind}_{COLUMNS[kind]}" in columns


def _curve(columns: Columns, kind: str, unit: str) -> StressCurve:
    amount = f"{kind}_{COLUMNS[kind]}"
    stress = next(name for name in columns if name.startswith(f"{kind}_stress"))
    told = stress.removeprefix(f"{kind}_stress").removeprefix("_")
    pairs = []
    cells = zip(columns[amount], columns[stress], strict=True)
    for line, (x, y) in enumerate(cells, 1):
        if x or y:
            pairs.append((_number(x, amount, line), _number(y, stress, line)))
    values = np.array(pairs, dtype=np.float64).reshape(-1, 2)
    return StressCurve(kind, values[:, 0], PA[told or unit] * values[:, 1])


def _number(cell: str, column: str, line: int) -> float:
    if not _parses(cell) or not np.isfinite(float(cell)):
        raise InputError(
            f"column '{column}': expected a number in line {line} of the data (got "
            f"'{cell}')"
        )
    return float(cell)


def _parses(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True

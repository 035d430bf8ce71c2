"""Measured points: CSV, MNI tags, and the markups of 3D Slicer (.fcsv, .mrk.json).

One table has a reader for every suffix, which returns one or more lists of points.

A point of 3D Slicer has a label and a state: it may not be placed yet, be unchecked or
hidden. Such points are left out, and of two lists their partners with them.
"""

import csv
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.measured import PointPairs
from physgnn.imaging.transforms import points_to_ras
from physgnn.io.medical.pairing import MarkedPoint, paired, why_in_order
from physgnn.io.medical.tag import read_tag
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.text import read_json, read_text
from physgnn.progress import Log, no_log

PAIR_COLUMNS = [f"{end}_{axis}" for end in ("source", "target") for axis in "xyz"]
POINT_COLUMNS = list("xyz")
WANTED = (PAIR_COLUMNS, POINT_COLUMNS)  # what the header of a table may name
# Slicer before 4.11 wrote numbers for the coordinate system.
FCSV_SYSTEMS = {"0": "RAS", "1": "LPS", "RAS": "RAS", "LPS": "LPS"}
# The columns of .fcsv, see vtkMRMLMarkupsFiducialStorageNode of 3D Slicer. Newer
# versions add the state of the position, of which 2 is "defined".
FCSV = {"vis": 8, "sel": 9, "label": 11, "positionStatus": 14}
FCSV_DEFINED = "2"
WHAT = "measured points"


def read_point_pairs(
    path: str | Path,
    target: str | Path | None = None,
    *,
    kind: type[PointPairs] = PointPairs,
    log: Log = no_log,
) -> PointPairs:
    """Read where points were and where they are now, RAS+ mm.

    Parameters
    ----------
    path : path
        A CSV of six columns (source and target x, y, z; RAS mm; a header is optional),
        a .tag of two volumes or an .mrk.json of two lists, source first; or, if
        `target` is given, the source points alone, in any of these formats.
    target : path, optional
        The target points: paired by their labels where both lists have them, else in
        the same order.
    kind : type
        What they are: pairs of the surface, or landmarks.
    log : callable
        Called with which points were left out, and why.

    Raises
    ------
    InputError
        If a file is not what its name says, or the points do not pair.
    """
    path = Path(path)
    with reading(path, WHAT):
        lists = _lists(path)
        if not any(lists):
            raise InputError("holds no points: export them again")
        if target is not None:
            _check_one_end(path, lists)
            others = _lists(Path(target))
            _check_one_end(Path(target), others)
            lists = [*lists[:1], *others[:1]]
        if len(lists) != 2:
            one, _ = BOTH_ENDS.get(path.suffix.lower(), (f"has {len(lists)}", ""))
            raise InputError(
                f"needs two lists of points, source and target ({one}): give the file "
                "of the targets too (--target, --landmarks-target or --bone-target)"
            )
        if target is not None and (why := why_in_order(*lists)):
            log(f"{path.name}: points are paired in the order they stand in: {why}")
        source, moved, names, left_out = paired(*lists)
        for name, why in left_out.items():
            log(f"{path.name}: pair '{name}' left out: {why}")
        return kind(source, moved, tuple(names), tuple(left_out))


def states_axes(path: str | Path) -> bool:
    """Return whether files like this one say which axes their points are in.

    A table does not, the other formats do, or have axes of their own.
    """
    return not str(path).lower().endswith(".csv")


def read_points(path: str | Path, *, log: Log = no_log) -> FloatArray:
    """Read one list of points, (n, 3), RAS+ mm.

    Parameters
    ----------
    path : path
        A CSV of three columns (RAS mm; a header is optional), a .tag of one volume, or
        markups of 3D Slicer, of which the first list is taken.
    log : callable
        Called with which points were left out, and why.

    Raises
    ------
    InputError
        If the file is not what its name says.
    """
    path = Path(path)
    with reading(path, WHAT):
        lists = _lists(path)
        if not lists:
            raise InputError("holds no list of points")
        _check_one_end(path, lists)
        for point in lists[0]:
            if point.missing:
                log(f"{path.name}: point '{point.label}' left out: {point.missing}")
        there = [point for point in lists[0] if not point.missing]
        found = np.array([one.position for one in there], np.float64).reshape(-1, 3)
        for k in np.flatnonzero(~np.isfinite(found).all(axis=1)):
            raise InputError(
                f"points must be finite (point '{there[k].label}' is "
                f"{found[k].tolist()}): correct it, or leave it out"
            )
        return found


def _lists(path: Path) -> list[list[MarkedPoint]]:
    """Return the lists of points in a file, by the reader of its suffix."""
    for suffix, reader in POINT_READERS.items():
        if path.name.lower().endswith(suffix):
            with reading(path, f"points, {suffix}"):
                return reader(path)
    raise InputError(
        f"measured points must be {', '.join(POINT_READERS)} (got '{path.name}')"
    )


def _check_one_end(path: Path, lists: list[list[MarkedPoint]]) -> None:
    """Raise InputError if a file that can hold both ends of pairs holds them."""
    if len(lists) == 2 and path.suffix.lower() in BOTH_ENDS:
        _, two = BOTH_ENDS[path.suffix.lower()]
        raise InputError(
            f"{path}: expected one list of points (it {two}, both ends of pairs): give "
            "no file of targets, or points of one time"
        )


def _read_csv(path: Path) -> list[list[MarkedPoint]]:
    """Return one list of a file of three columns, two of one of six."""
    text = read_text(path, names_in_latin1=True)
    rows = [row for row in csv.reader(_without_comments(text)) if row]
    columns = PAIR_COLUMNS if rows and len(rows[0]) >= 6 else POINT_COLUMNS
    if rows and not is_number(rows[0][0]):
        header = [name.strip().lower() for name in rows[0]]
        columns = next((names for names in WANTED if set(names) <= set(header)), [])
        if not columns:
            raise InputError(
                f"its header must name {' or '.join(map(', '.join, WANTED))} (got "
                f"{rows[0]})"
            )
        order = [header.index(name) for name in columns]
        rows = [[row[i] for i in order if i < len(row)] for row in rows[1:]]
    numbers = _numbers(rows, len(columns))
    ends = np.split(numbers, len(columns) // 3, axis=1)
    return [[MarkedPoint("", position) for position in end] for end in ends]


def _without_comments(text: str) -> list[str]:
    """Return the lines of a table; one after a # is a comment unless it names columns.

    NumPy writes the header of a table so.
    """
    lines = []
    for line in text.splitlines():
        plain = line.lstrip().lstrip("#")
        names = {name.strip().lower() for name in plain.split(",")}
        names_columns = any(set(wanted) <= names for wanted in WANTED)
        if names_columns or not line.lstrip().startswith("#"):
            lines.append(plain)
    return lines


def _read_fcsv(path: Path) -> list[list[MarkedPoint]]:
    text = read_text(path, names_in_latin1=True)
    system = re.search(r"^# CoordinateSystem = (\w+)\s*$", text, re.MULTILINE)
    if system is None or system[1] not in FCSV_SYSTEMS:
        raise InputError(
            "no '# CoordinateSystem = LPS' or RAS: export it from 3D Slicer"
        )
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    rows = list(csv.reader(lines))
    points = points_to_ras(
        _numbers([row[1:4] for row in rows], 3), FCSV_SYSTEMS[system[1]]
    )
    return [
        [
            MarkedPoint(fcsv_cell(row, "label"), point, _fcsv_missing(row))
            for row, point in zip(rows, points, strict=True)
        ]
    ]


def fcsv_cell(row: list[str], column: str) -> str:
    """Return what a row of a .fcsv has in a column; nothing if it ends before."""
    i = FCSV[column]
    return row[i].strip() if i < len(row) else ""


def _fcsv_missing(row: list[str]) -> str:
    if fcsv_cell(row, "positionStatus") not in ("", FCSV_DEFINED):
        return "not placed"
    if fcsv_cell(row, "sel") == "0":
        return "not selected"
    return "hidden" if fcsv_cell(row, "vis") == "0" else ""


def _read_mrk_json(path: Path) -> list[list[MarkedPoint]]:
    content = read_json(path)
    if not isinstance(content, dict) or not isinstance(content.get("markups"), list):
        raise InputError("no markups of 3D Slicer: export them as .mrk.json")
    return [_one_list(markup) for markup in content["markups"]]


def _one_list(markup: Mapping[str, Any]) -> list[MarkedPoint]:
    unit = markup.get("coordinateUnits", "mm")
    if unit not in ("mm", ["mm"]):
        raise InputError(f"coordinates must be in mm (got {unit})")
    controls = markup["controlPoints"]
    missing = [_json_missing(control) for control in controls]
    # what is not placed may have no position at all
    rows = [
        [0.0] * 3 if why == "not placed" else control["position"]
        for control, why in zip(controls, missing, strict=True)
    ]
    points = points_to_ras(_numbers(rows, 3), markup.get("coordinateSystem", "LPS"))
    return [
        MarkedPoint(str(control.get("label", "")).strip(), point, why)
        for control, point, why in zip(controls, points, missing, strict=True)
    ]


def _json_missing(control: Mapping[str, Any]) -> str:
    if control.get("positionStatus", "defined") != "defined":
        return "not placed"
    if not control.get("selected", True):
        return "not selected"
    return "" if control.get("visibility", True) else "hidden"


POINT_READERS: Mapping[str, Callable[[Path], list[list[MarkedPoint]]]] = {
    ".csv": _read_csv,
    ".tag": read_tag,
    ".fcsv": _read_fcsv,
    ".mrk.json": _read_mrk_json,
}
BOTH_ENDS = {
    ".csv": (
        "it has three columns, not six, which without a header are three and three, "
        f"or else {', '.join(PAIR_COLUMNS)}",
        "has six columns",
    ),
    ".tag": ("it has one volume, not two", "has two volumes"),
}
"""What is said of one list and of two, of formats that hold both ends side by side."""


def is_number(value: Any) -> bool:
    """Return whether a value is a number, or text that is one."""
    if isinstance(value, bool):
        return False
    try:
        float(value)
    except (TypeError, ValueError, OverflowError):
        return False
    return True


def _numbers(rows: list[list[Any]], width: int) -> FloatArray:
    for i, row in enumerate(rows):
        if len(row) != width or not all(is_number(value) for value in row):
            raise InputError(f"point {i + 1} must be {width} numbers (got {row})")
    return np.array(rows, dtype=np.float64).reshape(-1, width)

"""Measured points: CSV, and the markups of 3D Slicer (.fcsv, .mrk.json).

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
from physgnn.io.medical.pairing import MarkedPoint, paired
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.text import read_json, read_text
from physgnn.progress import Log, no_log

PAIR_COLUMNS = [f"{end}_{axis}" for end in ("source", "target") for axis in "xyz"]
POINT_COLUMNS = list("xyz")
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
        or markups of 3D Slicer: the source points, if `target` is given, else an
        .mrk.json of two lists, source first.
    target : path, optional
        Markups of the target points: paired by their labels where both lists have
        them, else in the same order.
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
        if path.name.endswith(".csv"):
            if target is not None:
                raise InputError("a CSV holds both ends: give no file of targets")
            rows = _read_csv(path, PAIR_COLUMNS)
            return kind(rows[:, :3], rows[:, 3:])
        lists = _read_markups(path)
        if target is not None:
            lists = [*lists[:1], *_read_markups(Path(target))[:1]]
        if len(lists) != 2:
            raise InputError(
                f"needs two lists of points, source and target (has {len(lists)}): "
                "give the file of the targets too"
            )
        source, moved, names, lines = paired(*lists)
        for line in lines:
            log(f"{path.name}: {line}")
        return kind(source, moved, tuple(names))


def read_points(path: str | Path, *, log: Log = no_log) -> FloatArray:
    """Read one list of points, (n, 3), RAS+ mm.

    Parameters
    ----------
    path : path
        A CSV of three columns (RAS mm; a header is optional), or markups of 3D Slicer,
        of which the first list is taken.
    log : callable
        Called with which points were left out, and why.

    Raises
    ------
    InputError
        If the file is not what its name says.
    """
    path = Path(path)
    with reading(path, WHAT):
        if path.name.endswith(".csv"):
            return _read_csv(path, POINT_COLUMNS)
        lists = _read_markups(path)
        if not lists:
            raise InputError("holds no list of points")
        for point in lists[0]:
            if point.missing:
                log(f"{path.name}: point '{point.label}' left out: {point.missing}")
        there = [point.position for point in lists[0] if not point.missing]
        return np.array(there, dtype=np.float64).reshape(-1, 3)


def _read_markups(path: Path) -> list[list[MarkedPoint]]:
    for suffix, reader in MARKUP_READERS.items():
        if path.name.endswith(suffix):
            with reading(path, f"{suffix} markups of 3D Slicer"):
                return reader(path)
    raise InputError(
        f"measured points must be .csv or {', '.join(MARKUP_READERS)} "
        f"(got '{path.name}')"
    )


def _read_csv(path: Path, columns: list[str]) -> FloatArray:
    text = read_text(path, names_in_latin1=True)
    rows = [row for row in csv.reader(text.splitlines()) if row]
    if rows and not _is_number(rows[0][0]):
        header = [name.strip().lower() for name in rows[0]]
        if not set(columns) <= set(header):
            raise InputError(
                f"its header must name {', '.join(columns)} (got {rows[0]})"
            )
        order = [header.index(name) for name in columns]
        rows = [[row[i] for i in order if i < len(row)] for row in rows[1:]]
    return _numbers(rows, len(columns))


def _read_fcsv(path: Path) -> list[list[MarkedPoint]]:
    text = read_text(path, names_in_latin1=True)
    system = re.search(r"^# CoordinateSystem = (\w+) *$", text, re.MULTILINE)
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
            MarkedPoint(_cell(row, "label"), point, _fcsv_missing(row))
            for row, point in zip(rows, points, strict=True)
        ]
    ]


def _cell(row: list[str], column: str) -> str:
    i = FCSV[column]
    return row[i].strip() if i < len(row) else ""


def _fcsv_missing(row: list[str]) -> str:
    if _cell(row, "positionStatus") not in ("", FCSV_DEFINED):
        return "not placed"
    if _cell(row, "sel") == "0":
        return "not selected"
    return "hidden" if _cell(row, "vis") == "0" else ""


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


MARKUP_READERS: Mapping[str, Callable[[Path], list[list[MarkedPoint]]]] = {
    ".fcsv": _read_fcsv,
    ".mrk.json": _read_mrk_json,
}


def _is_number(value: Any) -> bool:
    if isinstance(value, bool):
        return False
    try:
        float(value)
    except (TypeError, ValueError, OverflowError):
        return False
    return True


def _numbers(rows: list[list[Any]], width: int) -> FloatArray:
    for i, row in enumerate(rows):
        if len(row) != width or not all(_is_number(value) for value in row):
            raise InputError(f"point {i + 1} must be {width} numbers (got {row})")
    return np.array(rows, dtype=np.float64).reshape(-1, width)

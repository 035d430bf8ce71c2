"""Measured points: CSV, and the markups of 3D Slicer (.fcsv, .mrk.json)."""

import csv
import json
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.measured import PointPairs
from physgnn.imaging.transforms import points_to_ras

PAIR_COLUMNS = [f"{end}_{axis}" for end in ("source", "target") for axis in "xyz"]
POINT_COLUMNS = list("xyz")
# Slicer before 4.11 wrote numbers for the coordinate system.
FCSV_SYSTEMS = {"0": "RAS", "1": "LPS", "RAS": "RAS", "LPS": "LPS"}


def read_point_pairs(path: str | Path, target: str | Path | None = None) -> PointPairs:
    """Read where points were and where they are now, RAS+ mm.

    Parameters
    ----------
    path : path
        A CSV of six columns (source and target x, y, z; RAS mm; a header is optional),
        or markups of 3D Slicer: the source points, if `target` is given, else an
        .mrk.json of two lists, source first.
    target : path, optional
        Markups of the target points, in the same order.

    Raises
    ------
    InputError
        If a file is not what its name says, or the points do not pair.
    """
    path = Path(path)
    try:
        if path.name.endswith(".csv"):
            if target is not None:
                raise InputError("a CSV holds both ends: give no file of targets")
            rows = _read_csv(path, PAIR_COLUMNS)
            return PointPairs(rows[:, :3], rows[:, 3:])
        lists = _read_markups(path)
        if target is not None:
            lists = [*lists[:1], *_read_markups(Path(target))[:1]]
        if len(lists) != 2:
            raise InputError(
                f"needs two lists of points, source and target (has {len(lists)}): "
                "give the file of the targets too"
            )
        return PointPairs(*lists)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def read_points(path: str | Path) -> FloatArray:
    """Read one list of points, (n, 3), RAS+ mm.

    Parameters
    ----------
    path : path
        A CSV of three columns (RAS mm; a header is optional), or markups of 3D Slicer,
        of which the first list is taken.

    Raises
    ------
    InputError
        If the file is not what its name says.
    """
    path = Path(path)
    try:
        if path.name.endswith(".csv"):
            return _read_csv(path, POINT_COLUMNS)
        lists = _read_markups(path)
        if not lists:
            raise InputError("holds no list of points")
        return lists[0]
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _read_markups(path: Path) -> list[FloatArray]:
    for suffix, reader in MARKUP_READERS.items():
        if path.name.endswith(suffix):
            return reader(_text(path))
    raise InputError(
        f"measured points must be .csv or {', '.join(MARKUP_READERS)} "
        f"(got '{path.name}')"
    )


def _text(path: Path) -> str:
    try:
        return path.read_text("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read ({error})") from error


def _read_csv(path: Path, columns: list[str]) -> FloatArray:
    rows = [row for row in csv.reader(_text(path).splitlines()) if row]
    if rows and not _is_number(rows[0][0]):
        header = [name.strip().lower() for name in rows[0]]
        if not set(columns) <= set(header):
            raise InputError(
                f"its header must name {', '.join(columns)} (got {rows[0]})"
            )
        order = [header.index(name) for name in columns]
        rows = [[row[i] for i in order if i < len(row)] for row in rows[1:]]
    return _numbers(rows, len(columns))


def _read_fcsv(text: str) -> list[FloatArray]:
    system = re.search(r"^# CoordinateSystem = (\w+)\s*$", text, re.MULTILINE)
    if system is None or system[1] not in FCSV_SYSTEMS:
        raise InputError(
            "no '# CoordinateSystem = LPS' or RAS: export it from 3D Slicer"
        )
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    points = _numbers([row[1:4] for row in csv.reader(lines)], 3)
    return [points_to_ras(points, FCSV_SYSTEMS[system[1]])]


def _read_mrk_json(text: str) -> list[FloatArray]:
    try:
        return [_one_list(markup) for markup in json.loads(text)["markups"]]
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"no markups of 3D Slicer ({type(error).__name__}: {error})"
        ) from error


def _one_list(markup: Mapping[str, Any]) -> FloatArray:
    unit = markup.get("coordinateUnits", "mm")
    if unit not in ("mm", ["mm"]):
        raise InputError(f"coordinates must be in mm (got {unit})")
    rows = [
        point["position"]
        for point in markup["controlPoints"]
        if point.get("positionStatus", "defined") == "defined"
    ]
    return points_to_ras(_numbers(rows, 3), markup.get("coordinateSystem", "LPS"))


MARKUP_READERS: Mapping[str, Callable[[str], list[FloatArray]]] = {
    ".fcsv": _read_fcsv,
    ".mrk.json": _read_mrk_json,
}


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _numbers(rows: list[list[Any]], width: int) -> FloatArray:
    for i, row in enumerate(rows):
        if len(row) != width or not all(_is_number(value) for value in row):
            raise InputError(f"point {i + 1} must be {width} numbers (got {row})")
    return np.array(rows, dtype=np.float64).reshape(-1, width)

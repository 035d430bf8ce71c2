"""Points and curves of 3D Slicer (.mrk.json, .fcsv), MNI tags, and CSV."""

import csv
import io
import json
import re
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.imaging.transforms import points_to_ras
from physgnn.io.medical.markups import (
    FCSV_DEFINED,
    FCSV_SYSTEMS,
    POINT_COLUMNS,
    fcsv_cell,
    is_number,
)
from physgnn.io.medical.tag import COMMENT, POINTS, read_tag
from physgnn.io.plans.plan import NO_LINKS, Plan, shown
from physgnn.io.untrusted.text import read_json, read_text

# What stays itself when its control points move: kind → whether they are joined, and
# whether the last is joined to the first. A box or a plane would bend.
MARKUPS = {
    "Fiducial": (False, False),
    "Line": (True, False),
    "Angle": (True, False),
    "Curve": (True, False),
    "ClosedCurve": (True, True),
}
# Measured from the control points: 3D Slicer measures anew where the value is missing.
MEASURED = ("length", "angle", "area", "volume", "curvature mean", "curvature max")
FCSV_ROW = re.compile(r"([^,\n]*),([^,\n]*),([^,\n]*),([^,\n]*)(.*)", re.DOTALL)
TAG_ROW = re.compile(r"(\s*)(\S+)(\s+)(\S+)(\s+)([^\s;]+)(.*)", re.DOTALL)


def read_markups(path: Path) -> Plan:
    """Read markups: points, lines, angles and curves, by their control points.

    Points that are not placed stay so. What lies between the control points of a curve
    is interpolated by 3D Slicer, and not in the file.

    Raises
    ------
    InputError
        If they are planes, boxes or others that would not keep their shape.
    """
    content = read_json(path)
    if not isinstance(content, dict) or not isinstance(content.get("markups"), list):
        raise InputError("no markups of 3D Slicer: export them as .mrk.json")
    controls: list[tuple[dict[str, Any], str]] = []
    links = [NO_LINKS]
    for markup in content["markups"]:
        placed = _placed(markup)
        system = markup.get("coordinateSystem", "LPS")
        ids = np.arange(len(controls), len(controls) + len(placed))
        links.append(_links(ids, *MARKUPS[markup.get("type", "Fiducial")]))
        controls += [(control, system) for control in placed]
        _forget_measured(markup)
    if not controls:
        raise InputError("holds no point that is placed")
    points = [
        points_to_ras(np.array(control["position"], np.float64)[None], system)[0]
        for control, system in controls
    ]

    def rewritten(moved: FloatArray) -> bytes:
        for (control, system), point in zip(controls, moved, strict=True):
            written = points_to_ras(point[None], system)[0]
            control["position"] = [float(shown(x)) for x in written]
        return (json.dumps(content, indent=4, ensure_ascii=False) + "\n").encode()

    labels = tuple(str(control.get("label", "")).strip() for control, _ in controls)
    return Plan(np.array(points), rewritten, labels, links=np.concatenate(links))


def _placed(markup: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the control points that have a place."""
    kind = markup.get("type", "Fiducial")
    if kind not in MARKUPS:
        raise InputError(
            f"a plan may hold {', '.join(MARKUPS)} (got {kind}, which would not keep "
            "its shape): save points, lines and curves in a file of their own"
        )
    unit = markup.get("coordinateUnits", "mm")
    if unit not in ("mm", ["mm"]):
        raise InputError(f"coordinates must be in mm (got {unit})")
    placed = [
        control
        for control in markup["controlPoints"]
        if control.get("positionStatus", "defined") == "defined"
    ]
    for i, control in enumerate(placed):
        _numbers(control["position"], f"'{control.get('label', i + 1)}'")
    return placed


def _links(ids: IntArray, joined: bool, closed: bool) -> IntArray:
    if not joined or len(ids) < 2:
        return NO_LINKS
    return np.stack([ids, np.roll(ids, -1)], axis=1)[: None if closed else -1]


def _forget_measured(markup: dict[str, Any]) -> None:
    for measurement in markup.get("measurements", []):
        if measurement.get("name") in MEASURED:
            measurement.pop("value", None)


def read_fcsv(path: Path) -> Plan:
    """Read a list of points as 3D Slicer wrote it before version 5.

    Points that are not placed stay so.
    """
    lines = read_text(path, names_in_latin1=True).splitlines(keepends=True)
    found = re.search(r"^# CoordinateSystem = (\w+)\s*$", "".join(lines), re.MULTILINE)
    if found is None or found[1] not in FCSV_SYSTEMS:
        raise InputError(
            "no '# CoordinateSystem = LPS' or RAS: export it from 3D Slicer"
        )
    system = FCSV_SYSTEMS[found[1]]
    rows, points, labels = [], [], []
    for i, line in enumerate(lines):
        row = FCSV_ROW.fullmatch(line)
        if line.startswith("#") or not line.strip():
            continue
        if row is None:
            raise InputError(f"line {i + 1} must hold a name and three numbers")
        cells = next(csv.reader([line.rstrip()]))
        if fcsv_cell(cells, "positionStatus") not in ("", FCSV_DEFINED):
            continue
        points.append(_numbers(row.groups()[1:4], f"in line {i + 1}"))
        labels.append(fcsv_cell(cells, "label"))
        rows.append((i, row))

    def rewritten(moved: FloatArray) -> bytes:
        text = list(lines)
        for (i, row), point in zip(rows, points_to_ras(moved, system), strict=True):
            text[i] = ",".join([row[1], *map(shown, point)]) + row[5]
        return "".join(text).encode()

    return Plan(points_to_ras(_stacked(points), system), rewritten, tuple(labels))


def read_tags(path: Path) -> Plan:
    """Read MNI tags of one volume.

    Raises
    ------
    InputError
        If they are of two volumes: both ends of pairs are measured, not planned.
    """
    lists = read_tag(path)
    if len(lists) != 1:
        raise InputError(
            "a plan has points of one volume (it has two, both ends of pairs): give "
            "the points of the scan alone"
        )
    text = read_text(path, names_in_latin1=True)
    blank = COMMENT.sub(lambda comment: " " * len(comment[0]), text)
    found = POINTS.search(blank)
    assert found is not None  # read_tag has seen it
    start, end = found.span(1)
    lines = blank[start:end].splitlines(keepends=True)
    rows = [
        (i, row) for i, line in enumerate(lines) if (row := TAG_ROW.fullmatch(line))
    ]
    points = [_numbers((row[2], row[4], row[6]), "of a tag") for _, row in rows]

    def rewritten(moved: FloatArray) -> bytes:
        kept = list(lines)
        for (i, row), point in zip(rows, moved, strict=True):
            x, y, z = map(shown, point)
            kept[i] = f"{row[1]}{x}{row[3]}{y}{row[5]}{z}{row[7]}"
        return (text[:start] + "".join(kept) + text[end:]).encode()

    return Plan(_stacked(points), rewritten, tuple(one.label for one in lists[0]))


def read_table(path: Path) -> Plan:
    """Read a CSV of x, y, z, RAS mm; a header names further columns, which stay."""
    text = read_text(path, names_in_latin1=True)
    rows = [row for row in csv.reader(io.StringIO(text, newline="")) if row]
    header = [name.strip().lower() for name in rows[0]] if rows else []
    named = bool(rows) and not is_number(rows[0][0])
    wrong = not set(POINT_COLUMNS) <= set(header) if named else len(header) != 3
    if wrong:
        raise InputError(
            "a plan must have columns x, y and z, named so in a header if there are "
            f"others (got {rows[0] if rows else 'nothing'})"
        )
    places = [header.index(name) for name in POINT_COLUMNS] if named else [0, 1, 2]
    first = int(named)
    points = []
    for i, row in enumerate(rows[first:]):
        if len(row) <= max(places):
            raise InputError(f"point {i + 1} must be three numbers (got {row})")
        points.append(_numbers([row[k] for k in places], str(i + 1)))

    def rewritten(moved: FloatArray) -> bytes:
        written = io.StringIO()
        writer = csv.writer(written, lineterminator="\n")
        writer.writerows(rows[:first])
        for row, point in zip(rows[first:], moved, strict=True):
            kept = list(row)
            for k, x in zip(places, point, strict=True):
                kept[k] = shown(x)
            writer.writerow(kept)
        return written.getvalue().encode()

    labels = header.index("label") if named and "label" in header else None
    return Plan(
        _stacked(points),
        rewritten,
        ()
        if labels is None
        else tuple(row[labels] if labels < len(row) else "" for row in rows[first:]),
    )


def _stacked(points: list[FloatArray]) -> FloatArray:
    return np.array(points, np.float64).reshape(-1, 3)


def _numbers(values: Any, which: str) -> FloatArray:
    """Return three numbers; InputError names the point if they are not."""
    if len(values) != 3 or not all(is_number(value) for value in values):
        raise InputError(f"point {which} must be three numbers (got {list(values)})")
    return np.array([float(value) for value in values])

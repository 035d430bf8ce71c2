import json
from pathlib import Path

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.io.medical.markups import read_point_pairs

SOURCE = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.5], [-7.0, 8.0, 9.0]])
TARGET = SOURCE + np.array([0.5, -1.0, 2.0])


def fcsv(path: Path, points: np.ndarray, system: str) -> Path:
    lines = [
        "# Markups fiducial file version = 4.11",
        f"# CoordinateSystem = {system}",
        "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID",
    ]
    for i, (x, y, z) in enumerate(points):
        lines.append(f"{i},{x},{y},{z},0,0,0,1,1,1,0,F-{i},,")
    path.write_text("\n".join(lines) + "\n")
    return path


def mrk_json(path: Path, *lists: np.ndarray, system: str = "LPS") -> Path:
    markups = [
        {
            "type": "Fiducial",
            "coordinateSystem": system,
            "coordinateUnits": "mm",
            "controlPoints": [
                {"label": "x", "position": [0, 0, 0], "positionStatus": "undefined"},
                *({"position": point, "positionStatus": "defined"} for point in points),
            ],
        }
        for points in (points.tolist() for points in lists)
    ]
    path.write_text(json.dumps({"@schema": "", "markups": markups}))
    return path


def check(path: Path, target: Path | None = None) -> None:
    pairs = read_point_pairs(path, target)
    np.testing.assert_allclose(pairs.source, SOURCE)
    np.testing.assert_allclose(pairs.target, TARGET)


def test_csv_with_and_without_header(tmp_path: Path) -> None:
    rows = np.hstack([SOURCE, TARGET])
    plain, named = tmp_path / "plain.csv", tmp_path / "named.csv"
    np.savetxt(plain, rows, delimiter=",")
    check(plain)
    order = [5, 0, 1, 2, 3, 4]
    header = np.array(
        ["source_x", "source_y", "source_z", "target_x", "target_y", "target_z"]
    )
    np.savetxt(
        named,
        rows[:, order],
        delimiter=",",
        header=",".join(header[order]),
        comments="",
    )
    check(named)


@pytest.mark.parametrize(
    ("system", "sign"), [("LPS", -1), ("RAS", 1), ("1", -1), ("0", 1)]
)
def test_slicer_points_land_in_ras(system: str, sign: int, tmp_path: Path) -> None:
    axes = np.array([sign, sign, 1])
    check(
        fcsv(tmp_path / "s.fcsv", SOURCE * axes, system),
        fcsv(tmp_path / "t.fcsv", TARGET * axes, system),
    )
    if system in ("LPS", "RAS"):
        check(
            mrk_json(
                tmp_path / "both.mrk.json", SOURCE * axes, TARGET * axes, system=system
            )
        )
        check(
            mrk_json(tmp_path / "s.mrk.json", SOURCE * axes, system=system),
            fcsv(tmp_path / "t.fcsv", TARGET * axes, system),
        )


def test_bad_files_are_refused(tmp_path: Path) -> None:
    def written(name: str, text: str) -> Path:
        (tmp_path / name).write_text(text)
        return tmp_path / name

    for path, message in (
        (tmp_path / "absent.csv", "cannot be read"),
        (written("a.txt", ""), "must be .csv or"),
        (written("short.csv", "1,2,3\n"), "point 1 must be 6 numbers"),
        (written("word.csv", "1,2,3,4,5,x\n"), "point 1 must be 6 numbers"),
        (written("header.csv", "x,y,z\n1,2,3\n"), "header must name"),
        (written("none.fcsv", "1,2,3,4\n"), "CoordinateSystem"),
        (written("bad.mrk.json", "{}"), "no markups"),
        (written("text.mrk.json", "x"), "no markups"),
        (mrk_json(tmp_path / "one.mrk.json", SOURCE), "targets too"),
        (
            mrk_json(tmp_path / "hfs.mrk.json", SOURCE, TARGET, system="HFS"),
            "RAS or LPS",
        ),
        (mrk_json(tmp_path / "few.mrk.json", SOURCE, TARGET[:2]), "needs its target"),
    ):
        with pytest.raises(InputError, match=message) as caught:
            read_point_pairs(path)
        assert "\n" not in str(caught.value) and path.name in str(caught.value)

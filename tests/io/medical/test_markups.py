import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.io.medical.markups import read_point_pairs, read_points
from physgnn.io.medical.pairing import MarkedPoint, paired

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
    said = "# measured in the théâtre, 3 of them\n".encode("latin-1")
    named.write_bytes(said + b"# " + named.read_bytes() + said)
    check(named)
    plain.write_bytes(said + plain.read_bytes())
    check(plain)


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
        (written("a.txt", ""), r"must be \.csv, \.tag"),
        (written("short.csv", "1,2,3\n"), "three columns, not six.*--target"),
        (written("word.csv", "1,2,3,4,5,x\n"), "point 1 must be 6 numbers"),
        (written("header.csv", "a,b,c\n1,2,3\n"), "header must name"),
        (written("many.csv", "1,2,3,4,5,6,7\n"), "point 1 must be 6 numbers"),
        (written("none.fcsv", "1,2,3,4\n"), "CoordinateSystem"),
        (written("bad.mrk.json", "{}"), "no markups"),
        (written("text.mrk.json", "x"), "expected JSON"),
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


AXES = np.array([-1.0, -1.0, 1.0])


def marked_fcsv(path: Path, points: np.ndarray, states: dict[int, str]) -> Path:
    """Write as Slicer 5.6 does; a state is what stands for vis, sel and position."""
    rows = ["# Markups fiducial file version = 5.6", "# CoordinateSystem = LPS"]
    for i, (x, y, z) in enumerate(points * AXES):
        vis, sel, placed = states.get(i, "112")
        rows.append(
            f"{i},{x},{y},{z},0,0,0,1,{vis},{sel},0,P{i} \xe9,,,{placed},0"  # Latin-1
        )
    path.write_bytes("\n".join(rows).encode("latin-1"))
    return path


def marked_json(path: Path, points: np.ndarray, states: dict[int, str]) -> Path:
    controls = []
    for i, point in enumerate(points * AXES):
        vis, sel, placed = states.get(i, "112")
        controls.append(
            {
                "label": f"P{i} \xe9",
                "position": point.tolist() if placed == "2" else None,
                "positionStatus": "defined" if placed == "2" else "undefined",
                "visibility": vis == "1",
                "selected": sel == "1",
            }
        )
    path.write_text(json.dumps({"markups": [{"controlPoints": controls}]}), "utf-8-sig")
    return path


@pytest.mark.parametrize("write", [marked_fcsv, marked_json])
def test_a_point_that_is_left_out_takes_its_partner_along(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    points = np.random.default_rng(0).normal(size=(9, 3))
    suffix = ".fcsv" if write is marked_fcsv else ".mrk.json"
    before = write(tmp_path / f"s{suffix}", points, {2: "110", 4: "102"})
    after = write(tmp_path / f"t{suffix}", points + 1.0, {5: "012"})
    said: list[str] = []
    pairs = read_point_pairs(before, after, log=said.append)
    left = np.delete(points, [2, 4, 5], axis=0)
    np.testing.assert_allclose(pairs.source, left)
    assert pairs.left_out == ("P2 \xe9", "P4 \xe9", "P5 \xe9")
    np.testing.assert_allclose(pairs.target, left + 1.0)
    for i, why in ((2, "not placed"), (4, "not selected"), (5, "hidden")):
        assert any(f"'P{i} \xe9' left out: {why}" in line for line in said)
    np.testing.assert_allclose(read_points(before), np.delete(points, [2, 4], axis=0))


def test_labels_that_do_not_pair_are_said(tmp_path: Path) -> None:
    points = np.random.default_rng(0).normal(size=(4, 3))
    plain = tmp_path / "s.csv"
    np.savetxt(plain, points, delimiter=",")

    def named(name: str, labels: str) -> Path:
        rows = [
            f"{i},{x},{y},{z},0,0,0,1,1,1,0,{label},,"
            for i, ((x, y, z), label) in enumerate(zip(points, labels, strict=True))
        ]
        head = ["# Markups fiducial file version = 4.11", "# CoordinateSystem = RAS"]
        (tmp_path / name).write_text("\n".join([*head, *rows]) + "\n")
        return tmp_path / name

    for before, after, why in (
        (named("a.fcsv", "abcd"), named("b.fcsv", "dcba"), ""),
        (named("c.fcsv", "abcd"), named("d.fcsv", "aacd"), "label 'a' stands twice"),
        (named("e.fcsv", "abcd"), named("f.fcsv", "efgh"), "no label is in both lists"),
        (plain, named("g.fcsv", "abcd"), ""),
    ):
        said: list[str] = []
        read_point_pairs(before, after, log=said.append)
        assert any("in the order they stand in" in line for line in said) == bool(why)
        assert all(why in line for line in said)


def test_labels_pair_lists_in_any_order() -> None:
    points = [MarkedPoint(name, np.full(3, float(i))) for i, name in enumerate("abcd")]
    source, target, _, left_out = paired(points, [*points[:2], points[3]][::-1])
    np.testing.assert_array_equal(source, target)
    assert len(source) == 3 and left_out == {"c": "without a partner"}


def test_lists_without_common_labels_pair_by_their_order() -> None:
    def points(*names: str) -> list[MarkedPoint]:
        return [MarkedPoint(n, np.full(3, float(i))) for i, n in enumerate(names)]

    for other in (points("p", "q", "r"), points("", "", ""), points("p", "p", "a")):
        source, target, *_ = paired(points("a", "b", "c"), other)
        np.testing.assert_array_equal(source, target)
    with pytest.raises(InputError, match="labels of source and target must match"):
        paired(points("a", "b", "c"), points("a", "x", "y"))
    with pytest.raises(InputError, match="needs its target"):
        paired(points("", ""), points("", "", ""))


def tag(path: Path, *ends: np.ndarray, label: str = '""') -> Path:
    rows = [" ".join(f"{n!r}" for n in row) for row in np.hstack(ends).tolist()]
    path.write_text(
        f"MNI Tag Point File\nVolumes = {len(ends)};\n% a comment; with a mark\n\n"
        "Points =\n" + "\n".join(f" {row} {label}" for row in rows) + ";\n"
    )
    return path


def test_tags_of_one_and_two_volumes(tmp_path: Path) -> None:
    check(tag(tmp_path / "both.tag", SOURCE, TARGET))
    check(tag(tmp_path / "weighted.TAG", SOURCE, TARGET, label='1.0 1 1 "p"'))
    before, after = (
        tag(tmp_path / f"{name}.tag", points)
        for name, points in (("before", SOURCE), ("after", TARGET))
    )
    check(before, after)
    np.testing.assert_allclose(read_points(before), SOURCE)
    np.savetxt(tmp_path / "after.csv", TARGET, delimiter=",")
    check(before, tmp_path / "after.csv")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("", "", "one volume, not two.*--target"),
        ("MNI Tag", "Other", "expected an MNI Tag Point File"),
        ("Volumes = 1", "Volumes = 3", "'Volumes = 1;' or"),
        ("Volumes = 1", "Volumes = 2", "point 1 must be 6 coordinates"),
        ('"";', '""', "cut off"),
        ("1.0 2.0", "1.0 x", "cannot be read"),
        ("1.0 2.0", "1.0 nan", "finite|not two"),
    ],
)
def test_bad_tags(old: str, new: str, message: str, tmp_path: Path) -> None:
    path = tag(tmp_path / "a.tag", SOURCE)
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(InputError, match=message) as caught:
        read_point_pairs(path)
    assert "\n" not in str(caught.value) and "a.tag" in str(caught.value)


def test_both_ends_where_one_is_wanted(tmp_path: Path) -> None:
    both = tag(tmp_path / "both.tag", SOURCE, TARGET)
    one = tag(tmp_path / "one.tag", TARGET)
    for read in (lambda: read_point_pairs(both, one), lambda: read_points(both)):
        with pytest.raises(InputError, match=r"both\.tag: .*has two volumes"):
            read()


RESECT = Path("/work/shared/real/resect_case1_before_after.tag")


@pytest.mark.skipif(not RESECT.exists(), reason=f"needs {RESECT}")
def test_the_landmarks_of_a_patient() -> None:
    pairs = read_point_pairs(RESECT)
    assert len(pairs.source) == 13
    shift = np.linalg.norm(pairs.target - pairs.source, axis=1).mean()
    assert shift == pytest.approx(5.80, abs=0.005)


@pytest.mark.parametrize("number", ["nan", "inf"])
def test_points_that_are_not_finite_are_named(tmp_path: Path, number: str) -> None:
    """A craniotomy at nan was an error of ours."""
    (tmp_path / "p.csv").write_text(f"1,2,3\n4,{number},6\n")
    with pytest.raises(InputError, match=r"p\.csv: points must be finite \(point '"):
        read_points(tmp_path / "p.csv")


@pytest.mark.parametrize("text", ["", "x,y,z\n", "x,y,z,x2,y2,z2\n"])
def test_pairs_of_an_empty_file_are_no_pairs(tmp_path: Path, text: str) -> None:
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(InputError, match="holds no points"):
        read_point_pairs(tmp_path / "p.csv")

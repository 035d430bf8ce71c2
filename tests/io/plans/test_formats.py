"""Plans of every format: read, moved, written, read again."""

import json
from pathlib import Path

import nibabel as nib
import numpy as np
import pytest
import pyvista as pv
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

import plan_files
from physgnn.errors import InputError
from physgnn.io import read_surface
from physgnn.io.medical.markups import read_points
from physgnn.io.plans.formats import (
    PLAN_FORMATS,
    plan_named_like,
    plan_suffix,
    read_plan,
    write_plan,
)
from plan_files import LABELS, LPS, POINTS, TRACTS, WRITERS

SHIFT = np.array([1.5, -2.25, 3.0])
BALL = plan_files.ball()


@pytest.fixture(params=list(WRITERS))
def path(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    name: str = request.param
    WRITERS[name](tmp_path / name)
    return tmp_path / name


def expected(path: Path) -> np.ndarray:
    """Return the points of a file in RAS, as it was made."""
    suffix = plan_suffix(path)
    if suffix in (".trk", ".tck"):
        return np.concatenate(TRACTS)
    if suffix == ".stl":
        return BALL.points[BALL.regular_faces].reshape(-1, 3)
    return BALL.points if suffix in (".vtp", ".ply", ".obj") else POINTS


def test_every_format_has_a_test() -> None:
    assert {plan_suffix(name) for name in WRITERS} == set(PLAN_FORMATS)


def test_points_come_in_ras_and_leave_moved(path: Path, tmp_path: Path) -> None:
    plan = read_plan(path)
    np.testing.assert_allclose(plan.points, expected(path), atol=2e-5)
    out = tmp_path / f"moved-{path.name}"
    write_plan(out, plan.moved_to(plan.points + SHIFT))
    again = read_plan(out)
    np.testing.assert_allclose(again.points, expected(path) + SHIFT, atol=2e-5)
    assert again.labels == plan.labels
    np.testing.assert_array_equal(again.links, plan.links)
    write_plan(out, again.moved_to(again.points - SHIFT))
    back = read_plan(out).points
    np.testing.assert_allclose(back, plan.points, atol=2e-5)


def test_what_other_readers_find(path: Path, tmp_path: Path) -> None:
    """A second reader of each format, in the axes that the file says."""
    plan = read_plan(path)
    out = tmp_path / f"moved-{path.name}"
    write_plan(out, plan.moved_to(plan.points + SHIFT))
    suffix, moved = plan_suffix(path), expected(path) + SHIFT
    if suffix in (".trk", ".tck"):
        found = plan_files.all_points(nib.streamlines.load(out).streamlines)
    elif suffix in (".stl", ".vtp", ".ply", ".obj"):
        found, moved = read_surface(out).points, BALL.points + SHIFT
        found, moved = (np.array(sorted(a.round(3).tolist())) for a in (found, moved))
    else:
        kept = [0, 2] if suffix == ".mrk.json" else [0, 1, 2]  # one is not selected
        found, moved = read_points(out), moved[kept]
    np.testing.assert_allclose(found, moved, atol=2e-3)


@pytest.mark.parametrize("kind", ["Fiducial", "Line", "Angle", "Curve", "ClosedCurve"])
@pytest.mark.parametrize("system", ["LPS", "RAS"])
def test_markups_keep_all_but_their_places(
    kind: str, system: str, tmp_path: Path
) -> None:
    path, out = tmp_path / "a.mrk.json", tmp_path / "b.mrk.json"
    plan_files.write_markups(path, kind, system)
    plan = read_plan(path)
    np.testing.assert_allclose(plan.points, POINTS)
    assert plan.labels == LABELS
    assert len(plan.links) == {"Fiducial": 0, "ClosedCurve": 3}.get(kind, 2)
    write_plan(out, plan.moved_to(POINTS + SHIFT))
    before, after = (json.loads(p.read_text("utf-8")) for p in (path, out))
    sign = LPS if system == "LPS" else np.ones(3)
    for point, control in zip(
        POINTS, after["markups"][0]["controlPoints"], strict=False
    ):
        np.testing.assert_allclose(control["position"], sign * (point + SHIFT))
    for content in (before, after):
        for control in content["markups"][0]["controlPoints"]:
            control.pop("position", None)
    # a length that is no more right is left to be measured anew
    assert "value" not in after["markups"][0]["measurements"][0]
    del before["markups"][0]["measurements"][0]["value"]
    assert after == before


@pytest.mark.parametrize("system", ["LPS", "RAS", "0", "1"])
def test_points_of_older_slicer_keep_all_but_their_places(
    system: str, tmp_path: Path
) -> None:
    path, out = tmp_path / "a.fcsv", tmp_path / "b.fcsv"
    plan_files.write_fcsv(path, system)
    plan = read_plan(path)
    np.testing.assert_allclose(plan.points, POINTS)
    write_plan(out, plan)
    assert [line.split(b",", 4)[4:] for line in out.read_bytes().split(b"\r\n")] == [
        line.split(b",", 4)[4:] for line in path.read_bytes().split(b"\r\n")
    ]
    assert out.read_bytes().startswith(path.read_bytes()[:60])


def test_tags_and_tables_keep_what_else_is_there(tmp_path: Path) -> None:
    for name, more in (("plan.tag", "1 2 3"), ("plan.csv", "7")):
        WRITERS[name](tmp_path / name)
        plan = read_plan(tmp_path / name)
        assert plan.labels == LABELS
        write_plan(tmp_path / name, plan.moved_to(plan.points + SHIFT))
        text = (tmp_path / name).read_text("utf-8")
        assert text.count(more) >= 3 and "13.5" in text and "33.125" in text


def test_models_keep_colours_and_turn_their_normals(tmp_path: Path) -> None:
    """A ball squeezed flat: normals of an ellipsoid, not of a ball."""
    squeeze = np.diag([1.0, 1.0, 0.25])
    normals = BALL.points - 20.0
    normals = normals @ np.linalg.inv(squeeze)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    for name in ("plan.vtp", "binary.ply", "ascii.ply"):
        WRITERS[name](tmp_path / name)
        plan = read_plan(tmp_path / name)
        write_plan(tmp_path / name, plan.moved_to(plan.points @ squeeze))
        made = pv.read(tmp_path / name)
        sign = LPS if name.endswith(".vtp") else np.ones(3)
        np.testing.assert_allclose(made.points, BALL.points @ squeeze * sign, atol=1e-5)
        turned = np.asarray(made.point_data["Normals"]) * sign
        outward = (turned * normals).sum(axis=1)
        assert outward.min() > 0.99
        if name.endswith(".vtp"):
            np.testing.assert_array_equal(
                made.point_data["colours"], BALL.point_data["colours"]
            )
            np.testing.assert_array_equal(
                made.cell_data["thickness"], BALL.cell_data["thickness"]
            )
            assert list(made.field_data["SPACE"]) == ["LPS"]


@pytest.mark.parametrize("how", ["lines", "lz4", "ascii", "raw"])
def test_every_kind_of_vtp(how: str, tmp_path: Path) -> None:
    """Tracts as lines, and compressions that VTK alone unpacks."""
    made, path = BALL.copy(), tmp_path / "a.vtp"
    if how == "lines":
        made = pv.lines_from_points(POINTS)
        made.points = made.points.astype(float)
        made.point_data["fa"] = np.arange(3.0)
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(made)
    if how == "lz4":
        writer.SetCompressorTypeToLZ4()
    elif how == "ascii":
        writer.SetDataModeToAscii()
    elif how == "raw":
        writer.SetDataModeToAppended()
        writer.EncodeAppendedDataOff()
    writer.Write()
    plan = read_plan(path)
    np.testing.assert_allclose(plan.points, made.points, atol=1e-6)
    write_plan(path, plan.moved_to(plan.points + SHIFT))
    again = pv.read(path)
    np.testing.assert_allclose(again.points, made.points + SHIFT, atol=1e-6)
    assert again.n_cells == made.n_cells and again.n_lines == made.n_lines
    for name in made.point_data:
        np.testing.assert_allclose(
            again.point_data[name], made.point_data[name], atol=0.05
        )


def test_a_normal_of_each_face_stays_one_of_each_face(tmp_path: Path) -> None:
    path = tmp_path / "plan.obj"
    plan_files.write_obj(path)
    plan = read_plan(path)
    write_plan(path, plan)
    lines = [line.split() for line in path.read_text().splitlines()]
    normals = np.array([row[1:] for row in lines if row[0] == "vn"], float)
    cells = BALL.points[BALL.regular_faces] * LPS
    flat = np.cross(cells[:, 1] - cells[:, 0], cells[:, 2] - cells[:, 0])
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    np.testing.assert_allclose(normals, flat, atol=1e-6)
    assert next(row[4:] for row in lines if row[0] == "v") == ["0.5", "0.25", "1"]
    assert ["g", "tumour"] in lines and ["mtllib", "plan.mtl"] in lines


@pytest.mark.parametrize("binary", [True, False])
def test_facets_of_stl_get_their_normals(binary: bool, tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    plan_files.write_stl(path, binary=binary)
    head = path.read_bytes()[:80]
    plan = read_plan(path)
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    write_plan(path, plan.moved_to(plan.points @ turn.T))
    data = path.read_bytes()
    if binary:
        row = np.dtype([("n", "<f4", 3), ("x", "<f4", (3, 3)), ("a", "<u2")])
        table = np.frombuffer(data[84:], row)
        normals, corners = table["n"], table["x"]
        assert data[:80] == head
    else:
        rows = [line.split() for line in data.decode().splitlines()]
        normals = np.array([r[2:] for r in rows if r and r[0] == "facet"], float)
        corners = np.array([r[1:] for r in rows if r and r[0] == "vertex"], float)
        corners = corners.reshape(-1, 3, 3)
    wanted = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    np.testing.assert_allclose(normals, wanted, atol=1e-5)


def test_tracts_keep_scalars_properties_and_place(tmp_path: Path) -> None:
    path = tmp_path / "plan.trk"
    plan_files.write_trk(path)
    plan = read_plan(path)
    write_plan(path, plan.moved_to(plan.points + SHIFT))
    found = nib.streamlines.load(path)
    np.testing.assert_allclose(found.header["voxel_to_rasmm"], plan_files.TRK_AFFINE)
    assert [len(one) for one in found.streamlines] == [3, 2]
    np.testing.assert_allclose(found.streamlines[1], TRACTS[1] + SHIFT, atol=1e-5)
    np.testing.assert_allclose(found.tractogram.data_per_point["fa"][0], 0.25)
    weights = found.tractogram.data_per_streamline["weight"]
    np.testing.assert_allclose(weights, [[1.0], [2.0]])
    plan_files.write_tck(tmp_path / "plan.tck")
    write_plan(tmp_path / "plan.tck", read_plan(tmp_path / "plan.tck"))
    assert nib.streamlines.load(tmp_path / "plan.tck").header["step_size"] == "0.5"


def _patched(path: Path, at: int, value: bytes) -> None:
    data = path.read_bytes()
    path.write_bytes(data[:at] + value + data[at + len(value) :])


@pytest.mark.parametrize(
    ("at", "value", "hint"),
    [
        (988, b"\xff\xff\xff\x7f", "declares 2147483647 tracts and holds 2"),
        (988, b"\x01\x00\x00\x00", "more than the 1 tracts"),
        (1000, b"\xff\xff\xff\x7f", "tract 1 is longer than the file"),
        (1000, b"\xff\xff\xff\xff", "tract 1 is longer than the file"),
        (36, b"\xff\xff", "negative number"),
        (440, bytes(64), "does not say where in the scan"),
        (996, b"\x00\x00", "header is damaged"),
    ],
)
def test_sizes_of_tracts_are_looked_at_first(
    at: int, value: bytes, hint: str, tmp_path: Path
) -> None:
    path = tmp_path / "plan.trk"
    plan_files.write_trk(path)
    _patched(path, at, value)
    with pytest.raises(InputError, match=hint):
        read_plan(path)


def test_what_would_not_keep_its_shape_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.mrk.json"
    plan_files.write_markups(path, "ROI")
    with pytest.raises(
        InputError, match=r"a\.mrk\.json: .*\(got ROI, which would not keep"
    ):
        read_plan(path)
    path.write_text('{"markups": [{"type": "Fiducial", "controlPoints": []}]}')
    with pytest.raises(InputError, match="no point that is placed"):
        read_plan(path)
    tags = tmp_path / "a.tag"
    tags.write_text("MNI Tag Point File\nVolumes = 2;\nPoints =\n 1 2 3 4 5 6;\n")
    with pytest.raises(InputError, match="both ends of pairs"):
        read_plan(tags)
    (tmp_path / "a.csv").write_text("1,2,3,4,5,6\n")
    with pytest.raises(InputError, match="columns x, y and z"):
        read_plan(tmp_path / "a.csv")
    with pytest.raises(InputError, match="no such file"):
        read_plan(tmp_path / "b.tck")
    with pytest.raises(InputError, match=r"one of \.mrk\.json.*got 'b\.xyz'"):
        read_plan(tmp_path / "b.xyz")


def test_a_result_has_the_plans_own_format() -> None:
    assert plan_named_like("out/moved", "plan.mrk.json") == Path("out/moved.mrk.json")
    assert plan_named_like("moved.STL", "plan.stl") == Path("moved.STL")
    with pytest.raises(InputError, match=r"in its own format, \.stl \(got 'a\.ply'\)"):
        plan_named_like("a.ply", "plan.stl")


def test_points_that_are_not_placed_stay_and_none_at_all_is_said(
    tmp_path: Path,
) -> None:
    head = "# Markups fiducial file version = 5.6\n# CoordinateSystem = RAS\n"
    rows = ["1,1,2,3,0,0,0,1,1,1,0,a,,,2,0\n", "2,0,0,0,0,0,0,1,1,1,0,b,,,0,0\n"]
    path = tmp_path / "a.fcsv"
    path.write_text(head + "".join(rows))
    plan = read_plan(path)
    np.testing.assert_array_equal(plan.points, [[1.0, 2.0, 3.0]])
    assert plan.labels == ("a",)
    written = plan.moved_to(plan.points + 1.0).as_bytes().decode()
    assert written == head + rows[0].replace("1,2,3", "2.0,3.0,4.0") + rows[1]
    for text in (head, head + rows[1]):
        path.write_text(text)
        with pytest.raises(InputError, match="holds no point that is placed"):
            read_plan(path)
    (tmp_path / "a.csv").write_text("x,y,z\n")
    with pytest.raises(InputError, match="holds no point that is placed"):
        read_plan(tmp_path / "a.csv")

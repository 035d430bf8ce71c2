"""Everything that the operating theatre gives, through the command line."""

import json
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
import SimpleITK as sitk
from block_shifts import leaning
from scipy.spatial.transform import Rotation

from meshes import block_mesh
from physgnn.cli import main
from physgnn.geometry import boundary_surface
from physgnn.io import read_mesh, write_mesh

LPS = np.diag([-1.0, -1.0, 1.0])
TURN = Rotation.from_rotvec([0.2, 0.1, -0.3]).as_matrix()
SHIFT = np.array([30.0, -12.0, 7.0])


def run(*words: object) -> int:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["physgnn", *map(str, words)])
        try:
            main()
        except SystemExit as end:
            return int(end.code or 0)
    return 0


def to_tracker(points: np.ndarray) -> np.ndarray:
    return (points - SHIFT) @ TURN


@pytest.fixture
def theatre(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A mesh, and pairs, landmarks and surfaces in files, in a tracker's space."""
    monkeypatch.chdir(tmp_path)
    body = block_mesh(5, side=80.0)
    write_mesh("case.vtu", body)
    u = leaning(body, 8.0)
    x, y, z = body.points.T
    inside = (z > 20) & (z < 80) & (x > 0) & (x < 80) & (y > 0) & (y < 80)
    chosen = {"top": body.point_set("loaded"), "deep": np.flatnonzero(inside)[::4]}
    noise = 0.3 * np.random.default_rng(0).normal(size=(2, 200, 3))
    for (name, which), error in zip(chosen.items(), noise, strict=True):
        points = body.points[which]
        after = points + u[which] + error[: len(points)]
        if name == "top":
            after[[7, 28]] = after[[28, 7]]
        both = np.hstack([to_tracker(points), to_tracker(after)])
        np.savetxt(f"{name}.csv", both, delimiter=",")
        half = np.hstack([points, to_tracker(after)])
        np.savetxt(f"{name}-half.csv", half, delimiter=",")
    cloud = (body.points + u)[chosen["top"]]
    np.savetxt("cloud.csv", to_tracker(cloud), delimiter=",")
    outer = boundary_surface(body)
    moved = to_tracker(outer.points + u)
    pv.PolyData.from_regular_faces(moved, outer.faces.astype(int)).save("whole.ply")
    transform = sitk.AffineTransform(3)  # from the scan to the tracker, LPS
    transform.SetMatrix((LPS @ TURN.T @ LPS).ravel().tolist())
    transform.SetTranslation((-LPS @ TURN.T @ SHIFT).tolist())
    sitk.WriteTransform(transform, "to-scan.h5")
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = TURN, SHIFT
    np.savetxt("to-scan.txt", matrix)
    return tmp_path


def error_of(theatre: Path, name: str) -> float:
    """Mean error over mean shift."""
    found = np.asarray(pv.read(theatre / name)["displacement_mm"])
    truth = leaning(read_mesh("case.vtu"), 8.0)
    size = np.linalg.norm(truth, axis=1).mean()
    return float(np.linalg.norm(found - truth, axis=1).mean() / size)


def test_all_kinds_count_in_one_call_and_bad_pairs_are_named(
    theatre: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ("--points", "top.csv", "--landmarks", "deep.csv", "--surface", "cloud.csv")
    how = ("--noise-mm", 0.5, "--surface-noise-mm", 1.0, "--misfits", "misfits.csv")
    space = ("--initial-transform", "to-scan.h5")
    assert run("register", "case.vtu", *given, *how, *space, "-o", "out.vtu") in (0, 3)
    said = capsys.readouterr()
    assert "2 of" in said.out and "rigid offset" in said.out
    assert "outlier, pairs '8':" in said.err and "outlier, pairs '29':" in said.err
    assert error_of(theatre, "out.vtu") < 0.2
    text = (theatre / "misfits.csv").read_text().splitlines()
    assert text[0] == "kind,label,x_mm,y_mm,z_mm,distance_mm,weight"
    kinds = {line.split(",")[0] for line in text[1:]}
    assert kinds == {"pairs", "landmarks", "surface"}


def test_a_status_names_the_pairs_that_it_is_without(
    theatre: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pairs = np.loadtxt(theatre / "top.csv", delimiter=",")
    for name, ends, unplaced in (
        ("before", pairs[:, :3], 2),
        ("after", pairs[:, 3:], 5),
    ):
        points = [
            {
                "label": f"P{i}",
                "position": at.tolist(),
                "positionStatus": "undefined" if i == unplaced else "defined",
            }
            for i, at in enumerate(ends)
        ]
        markups = [{"coordinateSystem": "RAS", "controlPoints": points}]
        (theatre / f"{name}.mrk.json").write_text(json.dumps({"markups": markups}))
    both = "--points", "before.mrk.json", "--target", "after.mrk.json"
    place = "--initial-transform", "to-scan.txt"
    assert run("register", "case.vtu", *both, *place, "-o", "shift.vtu") in (0, 3)
    assert " without P2, P5: " in capsys.readouterr().out.replace("\n", " ")


def test_every_way_to_the_scan_is_the_same(theatre: Path) -> None:
    ways = {
        "h5.vtu": ("deep.csv", "to-scan.h5", "both"),
        "txt.vtu": ("deep.csv", "to-scan.txt", "both"),
        "half.vtu": ("deep-half.csv", "to-scan.txt", "after"),
    }
    for out, (landmarks, transform, ends) in ways.items():
        given = ("--landmarks", landmarks, "--initial-transform", transform)
        how = ("--transformed", ends, "--noise-mm", 0.5)
        run("register", "case.vtu", *given, *how, "-o", out)
    found = [pv.read(theatre / name)["displacement_mm"] for name in ways]
    np.testing.assert_allclose(found[1], found[0], atol=1e-4)
    np.testing.assert_allclose(found[2], found[0], atol=1e-4)


def test_a_whole_surface_alone_is_enough(theatre: Path) -> None:
    given = ("--whole-surface", "whole.ply", "--initial-transform", "to-scan.txt")
    run("register", "case.vtu", *given, "--rigid-offset", "-o", "out.vtu")
    assert error_of(theatre, "out.vtu") < 0.6


def test_landmarks_in_another_space_are_refused_in_a_line(
    theatre: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    del theatre
    assert run("register", "case.vtu", "--landmarks", "deep.csv", "-o", "o.vtu") == 2
    said = capsys.readouterr().err
    assert "landmarks must lie inside the brain (outside of it: '" in said
    assert "--initial-transform" in said and "Traceback" not in said


BONE = np.array(
    [[-5.0, 10, 70], [-6, 70, 75], [85, 15, 75], [86, 70, 70], [40, -6, 60]]
)
INTO = np.array([0.0, 0.0, -8.0])  # the navigation is off, in the scan's space


def bone_files(mm: np.ndarray = INTO) -> None:
    """Bone points and the top as a navigation that is off finds them now."""
    found = BONE + mm + 0.2 * np.random.default_rng(1).normal(size=BONE.shape)
    np.savetxt("bone.csv", np.hstack([BONE, to_tracker(found)]), delimiter=",")
    top = np.loadtxt("top-half.csv", delimiter=",")
    top[:, 3:] += mm @ TURN
    np.savetxt("off.csv", top, delimiter=",")
    for name, points in (("in-scan", BONE), ("now", to_tracker(found))):
        rows = [f"{i},{-x},{-y},{z},0,0,0,1,1,1,0,rim {i},," for i, (x, y, z)
                in enumerate(points)]  # fmt: skip
        if name == "now":
            rows.reverse()  # they have names
        head = "# Markups fiducial file version = 5.0\n# CoordinateSystem = LPS\n"
        Path(f"{name}.fcsv").write_text(head + "\n".join(rows) + "\n")


SPACE = ("--initial-transform", "to-scan.h5", "--transformed", "after")
TOLD = ("--noise-mm", 0.5)
OF_BONE = ("--bone-noise-mm", 0.3)


def test_bone_points_take_out_what_the_navigation_is_off(
    theatre: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bone_files()
    given = ("--points", "off.csv", *SPACE, *TOLD)
    run("register", "case.vtu", *given, "-o", "alone.vtu")
    said = capsys.readouterr()
    assert "not checked against bone" in said.out
    assert "not checked" in str(pv.read("alone.vtu").field_data["navigation"])
    bone = ("--bone", "bone.csv", *OF_BONE, "--misfits", "misfits.csv")
    run("register", "case.vtu", *given, *bone, "-o", "out.vtu")
    said = capsys.readouterr()
    assert "corrected; 5 bone points" in said.out
    assert "not checked" not in said.out + said.err
    assert error_of(theatre, "out.vtu") < 0.4 < error_of(theatre, "alone.vtu")
    lines = [str(line) for line in pv.read("out.vtu").field_data["navigation"]]
    z = float(lines[1].split(" +- ")[0].split()[-1])
    assert z == pytest.approx(-8.0, abs=0.6) and len(lines) == 9
    kinds = [row.split(",")[0] for row in Path("misfits.csv").read_text().split()]
    assert kinds.count("bone") == 5
    pair = ("--bone", "in-scan.fcsv", "--bone-target", "now.fcsv", *OF_BONE)
    run("register", "case.vtu", *given, *pair, "-o", "pair.vtu")
    found = [pv.read(name)["displacement_mm"] for name in ("out.vtu", "pair.vtu")]
    np.testing.assert_allclose(found[1], found[0], atol=1e-3)


def test_a_series_takes_bone_points_of_each_state(theatre: Path) -> None:
    bone_files()
    Path("states.csv").write_text(
        "name,points,bone\nchecked,off.csv,bone.csv\nnot,off.csv,\n"
    )
    noise = (*TOLD, *OF_BONE)
    run("register", "case.vtu", "--series", "states.csv", *SPACE, *noise, "-o", "s")
    head, checked, alone = (theatre / "s/results.csv").read_text().splitlines()
    assert head.endswith("offset_mm,bone")
    assert '"5 bone points' in checked and alone.endswith(",")
    assert (theatre / "s/checked-misfits.csv").read_text().count("bone,") == 5


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("--bone", "bone.csv"), "nothing was measured of the brain"),
        (("--points", "off.csv", "--bone-target", "now.fcsv"), "without --bone"),
        (("--points", "off.csv", "--bone", "in-scan.fcsv"), "--bone-target"),
        (("--points", "off.csv", "--bone", "deep-half.csv"), "outside of the brain"),
        (("--points", "off.csv", "--bone", "case.vtu"), "must be .csv"),
        (
            ("--points", "off.csv", "--bone", "bone.csv", "--bone-noise-mm", 0),
            "noise_mm of bone must be in [0.0001, 20]",
        ),
    ],
)
def test_bad_bone_points_are_one_line(
    given: tuple, said: str, theatre: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bone_files()
    assert run("register", "case.vtu", *given, *SPACE, "-o", "o.vtu") == 2
    error = capsys.readouterr().err
    assert said in error and "Traceback" not in error
    assert len(error.strip().splitlines()) == 1
    assert not (theatre / "o.vtu").exists()


@pytest.mark.parametrize(
    ("table", "more", "said"),
    [
        ("name,points\na,off.csv\n", ("--bone-noise-mm", 1), "without --bone"),
        ("name,points\na,off.csv\n", ("--contrast", "t2"), "without --intraoperative"),
        ("name,points\na,off.csv\n", ("--transformed", "after"), "--initial-transf"),
        ("name,points,bone_target\na,off.csv,now.fcsv\n", (), "no bone to pair"),
        (
            "name,points\na,off.csv\n",
            ("--bone", "bone.csv", "--rigid-offset"),
            "beside",
        ),
    ],
)
def test_what_no_state_of_a_series_uses_is_refused_beforehand(
    table: str,
    more: tuple,
    said: str,
    theatre: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    bone_files()
    Path("states.csv").write_text(table)
    assert run("register", "case.vtu", "--series", "states.csv", *more, "-o", "s") == 2
    error = capsys.readouterr().err
    assert said in error and len(error.strip().splitlines()) == 1
    assert not (theatre / "s").exists()


def test_it_is_said_that_the_bone_in_the_scan_was_transformed_too(
    theatre: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bone_files()
    np.savetxt(theatre / "still.txt", np.eye(4))
    given = ("--points", "off.csv", "--bone", "bone.csv")
    given = (*given, "--initial-transform", "still.txt", *TOLD, *OF_BONE)
    run("register", "case.vtu", *given, "-o", "out.vtu")
    assert "--transformed after" in capsys.readouterr().err
    run("register", "case.vtu", *given, "--transformed", "after", "-o", "out.vtu")
    assert "--transformed after" not in capsys.readouterr().err

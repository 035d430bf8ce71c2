"""Plans carried along by the stage and the command."""

import json
from pathlib import Path

import nibabel as nib
import numpy as np
import pytest

import physgnn
import plan_files
from meshes import block_mesh
from physgnn.cli import main
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.io import write_prediction
from physgnn.io.medical.images.formats import write_image
from physgnn.io.plans.formats import read_plan
from plan_files import POINTS, WRITERS

BODY = block_mesh(4, side=40.0)
A = np.array([[0.02, 0.05, 0.0], [-0.03, 0.01, 0.04], [0.0, -0.02, 0.03]])


@pytest.fixture
def shift(tmp_path: Path) -> Path:
    """A linear displacement, which every point in the body has exactly."""
    u = BODY.points @ A.T + [1.0, -2.0, 0.5]
    write_prediction(tmp_path / "shift.vtu", BODY, {"displacement_mm": u})
    return tmp_path / "shift.vtu"


def moved(points: np.ndarray) -> np.ndarray:
    return points + points @ A.T + [1.0, -2.0, 0.5]


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_moves_forward(name: str, shift: Path, tmp_path: Path) -> None:
    WRITERS[name](tmp_path / name)
    before = read_plan(tmp_path / name).points
    said: list[str] = []
    suffix = name[name.index(".") :]
    physgnn.warp(tmp_path / name, shift, tmp_path / "there", log=said.append)
    after = read_plan(tmp_path / f"there{suffix}").points
    np.testing.assert_allclose(after, moved(before), atol=2e-5)
    assert said[0].startswith(f"{len(before)} points moved by")
    assert not any("outside" in line for line in said)


def test_points_outside_are_named(shift: Path, tmp_path: Path) -> None:
    path, out = tmp_path / "a.csv", tmp_path / "b.csv"
    path.write_text(
        "label,x,y,z\nentry,20,20,45\ntarget,20,20,20\nfar,20,20,90\n,20,-3,9\n"
    )
    said: list[str] = []
    physgnn.warp(path, shift, out, log=said.append)
    near, far = said[1:]
    assert "less with distance: 'entry' (5.0 mm), point 4 (3.0 mm)" in near
    assert far.endswith("mm or more away, not moved: 'far' (50.0 mm)")
    after = read_plan(out).points
    np.testing.assert_allclose(after[2], [20, 20, 90])
    full = moved(np.array([[20.0, 20.0, 40.0]]))[0] - [20, 20, 40]
    fade = float(far.split("brain, ")[1].split(" mm")[0])
    np.testing.assert_allclose(
        after[0] - [20, 20, 45], (1 - 5 / fade) * full, rtol=0.02
    )
    path.write_text("400,0,0\n500,0,0\n")
    out.unlink()
    with pytest.raises(InputError, match=r"do not meet .*same world coordinates"):
        physgnn.warp(path, shift, out)
    assert not out.exists()


def test_a_curve_says_how_far_tissue_leaves_it(tmp_path: Path) -> None:
    """u = z²/100 along x: halfway between two points it differs from their mean."""
    u = np.zeros_like(BODY.points)
    u[:, 0] = BODY.points[:, 2] ** 2 / 100
    write_prediction(tmp_path / "u.vtu", BODY, {"displacement_mm": u})
    line = {
        "type": "Line",
        "coordinateSystem": "RAS",
        "controlPoints": [{"label": "a", "position": [20.0, 20.0, z]} for z in (0, 40)],
    }
    (tmp_path / "a.mrk.json").write_text(json.dumps({"markups": [line]}))
    said: list[str] = []
    physgnn.warp(
        tmp_path / "a.mrk.json", tmp_path / "u.vtu", tmp_path / "b", log=said.append
    )
    assert "up to 4.00 mm beside it" in said[-1]  # (0 + 16) / 2 − 4


def test_a_plan_moves_with_the_scan(tmp_path: Path) -> None:
    """A bright spot of the warped image lies where the point goes, in LPS and RAS."""
    u = np.stack([np.full(BODY.n_points, 3.0), 0.1 * BODY.points[:, 2],
                  np.full(BODY.n_points, -2.0)], 1)  # fmt: skip
    write_prediction(tmp_path / "u.vtu", BODY, {"displacement_mm": u})
    affine = np.diag([-1.0, -1.0, 1.0, 1.0])
    affine[:3, 3] = [40.0, 40.0, 0.0]
    x = np.moveaxis(np.indices((41, 41, 41)), 0, -1) @ affine[:3, :3] + affine[:3, 3]
    blob = np.exp(-((x - POINTS[1]) ** 2).sum(-1) / 8.0)
    write_image(tmp_path / "t1.nii", Image(blob, affine))
    plan_files.write_markups(tmp_path / "p.mrk.json")
    plan_files.write_trk(tmp_path / "p.trk")
    for name in ("t1.nii", "p.mrk.json", "p.trk"):
        physgnn.warp(tmp_path / name, tmp_path / "u.vtu", tmp_path / f"moved-{name}")
    image = nib.load(tmp_path / "moved-t1.nii").get_fdata()
    centre = (image[..., None] * x).sum((0, 1, 2)) / image.sum()
    for name in ("p.mrk.json", "p.trk"):
        there = read_plan(tmp_path / f"moved-{name}").points[1]
        np.testing.assert_allclose(there, centre, atol=0.05)


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        (("plan.stl", "-o", "out.ply"), "in its own format, .stl (got 'out.ply')"),
        (("plan.stl", "--labels", "-o", "o.stl"), "--labels is for images"),
        (("plan.stl", "--jacobian", "j.nii", "-o", "o"), "--jacobian is for images"),
        (("plan.stl", "-o", "no/o.stl"), "the folder no is not there"),
        (("model.vtk", "-o", "o.vtk"), "is warped as .stl, .ply, .obj, .vtp"),
        (("absent.trk", "-o", "o.trk"), "no such file"),
    ],
)
def test_mistakes_are_one_line(
    words: tuple[str, ...],
    hint: str,
    shift: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    plan_files.write_stl(tmp_path / "plan.stl")
    plan_files.ball().save("model.vtk")
    before = set(tmp_path.iterdir())
    monkeypatch.setattr(
        "sys.argv", ["physgnn", "warp", words[0], str(shift), *words[1:]]
    )
    with pytest.raises(SystemExit) as end:
        main()
    said = capsys.readouterr().err
    assert end.value.code == 2 and hint in said and "Traceback" not in said
    assert set(tmp_path.iterdir()) == before


def test_the_command_prints_what_it_wrote(
    shift: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    plan_files.write_markups(tmp_path / "plan.mrk.json")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        "sys.argv", ["physgnn", "warp", "plan.mrk.json", shift.name, "-o", "moved"]
    )
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 0
    assert capsys.readouterr().out == "moved.mrk.json\n"
    np.testing.assert_allclose(read_plan("moved.mrk.json").points, moved(POINTS))


def test_there_and_back_is_where_it_was(tmp_path: Path) -> None:
    """Of points to rounding, of an image to what is lost between voxels."""
    z = BODY.points[:, 2]
    u = np.stack([z**2 / 200, np.sin(z / 8), -z / 10], axis=1)
    write_prediction(tmp_path / "u.vtu", BODY, {"displacement_mm": u})
    plan_files.write_tck(tmp_path / "a.tck")
    x = np.moveaxis(np.indices((41, 41, 41)), 0, -1).astype(float)
    blob = np.exp(-((x - POINTS[1]) ** 2).sum(-1) / 32.0)
    write_image(tmp_path / "a.nii", Image(blob, np.eye(4)))
    for suffix in (".tck", ".nii"):
        a, b, c = (tmp_path / f"{name}{suffix}" for name in "abc")
        physgnn.warp(a, tmp_path / "u.vtu", b)
        physgnn.warp(b, tmp_path / "u.vtu", c, back=True)
    before, after = (read_plan(tmp_path / f"{name}.tck").points for name in "ac")
    there = read_plan(tmp_path / "b.tck").points
    np.testing.assert_allclose(after, before, atol=1e-4)
    assert np.linalg.norm(there - before, axis=1).min() > 1.0
    image = nib.load(tmp_path / "c.nii").get_fdata()
    inside = blob > 0.05
    assert np.abs(image - blob)[inside].max() < 0.05  # twice between voxels
    assert np.abs(nib.load(tmp_path / "b.nii").get_fdata() - blob).max() > 0.2


def test_what_folds_has_no_way_back(tmp_path: Path) -> None:
    u = np.zeros_like(BODY.points)
    u[:, 0] = -2.0 * BODY.points[:, 0]
    write_prediction(tmp_path / "u.vtu", BODY, {"displacement_mm": u})
    plan_files.write_tags(tmp_path / "a.tag")
    with pytest.raises(InputError, match="no way back: it turns 384 of 384 cells"):
        physgnn.warp(
            tmp_path / "a.tag", tmp_path / "u.vtu", tmp_path / "b.tag", back=True
        )
    assert not (tmp_path / "b.tag").exists()


def test_named_points_say_how_uncertain_they_are(tmp_path: Path) -> None:
    fields = {
        "displacement_mm": np.ones_like(BODY.points),
        "deviation_mm": BODY.points[:, 2] / 10,
    }
    write_prediction(tmp_path / "u.vtu", BODY, fields)
    (tmp_path / "a.csv").write_text("label,x,y,z\na,9,9,20\nb,9,9,30\nskin,9,9,45\n")
    said: list[str] = []
    physgnn.warp(
        tmp_path / "a.csv", tmp_path / "u.vtu", tmp_path / "b.csv", log=said.append
    )
    assert said[-1] == "standard deviation in the brain: 'a' 2.0 mm, 'b' 3.0 mm"
    fields["deviation_mm"] = np.full(BODY.n_points, np.nan)
    write_prediction(tmp_path / "u.vtu", BODY, fields)
    with pytest.raises(InputError, match="'deviation_mm' must be finite"):
        physgnn.warp(tmp_path / "a.csv", tmp_path / "u.vtu", tmp_path / "c.csv")
    assert not (tmp_path / "c.csv").exists()

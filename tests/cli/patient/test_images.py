"""The commands for images, as a user types them."""

from dataclasses import replace
from pathlib import Path

import nibabel as nib
import numpy as np
import pytest
import pyvista as pv
from block_shifts import leaning

from meshes import block_mesh
from physgnn.cli import main
from physgnn.geometry.image import Image, LabelVolume
from physgnn.geometry.meshing import tetgen_process
from physgnn.io import read_mesh, write_mesh, write_prediction
from physgnn.io.medical.images.formats import read_image, write_image


def run(*words: object, code: int = 0) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["physgnn", *map(str, words)])
        try:
            main()
        except SystemExit as end:
            assert end.code == code, end.code
        else:
            assert code == 0


@pytest.mark.skipif(not tetgen_process.available(), reason="needs the tetgen extra")
def test_a_label_map_becomes_a_mesh(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    x = np.moveaxis(np.indices((26, 26, 26)), 0, -1) * 4.0
    ball = np.linalg.norm(x - 50, axis=-1) < 40
    write_image(tmp_path / "seg.nii", LabelVolume(ball * 2, np.diag([4, 4, 4, 1.0])))
    case = tmp_path / "case.vtu"
    seg = tmp_path / "seg.nii"
    run("mesh", seg, "--labels", "brain=2", "--target-points", 1200, "-o", case)
    volume = ball.sum() * 64
    assert read_mesh(case).cell_volumes.sum() == pytest.approx(volume, rel=0.02)
    assert "apart on average" in capsys.readouterr().err


def test_measured_points_become_a_deformed_image(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    body = block_mesh(4, side=80.0)
    case, csv, out = (tmp_path / name for name in ("case.vtu", "m.csv", "out.vtu"))
    write_mesh(case, body)
    top = body.points[body.point_set("loaded")]
    shift = leaning(body, 12.0)[body.point_set("loaded")]
    np.savetxt(csv, np.hstack([top, top + shift]), delimiter=",")
    run("register", case, "--points", csv, "--noise-mm", 0.5, "-o", out)
    said = capsys.readouterr().out
    assert "misfit" in said and "rigid offset" in said
    x = np.moveaxis(np.indices((30, 30, 30)), 0, -1) * 4.0 - 20.0
    affine = np.diag([4.0, 4.0, 4.0, 1.0])
    affine[:3, 3] = -20.0
    layer = ((x[..., 2] > 40) & (x >= 0).all(-1) & (x <= 80).all(-1)) * 1.0
    write_image(tmp_path / "t1.nii", Image(layer, affine))
    moved, transform = tmp_path / "moved.nii", tmp_path / "t.h5"
    run("warp", tmp_path / "t1.nii", out, "-o", moved, "--field", transform)
    assert transform.stat().st_size > 1000
    after = np.asarray(read_image(moved).data)
    heights = [np.average(x[..., 2], weights=image) for image in (layer, after)]
    assert heights[1] < heights[0] - 1.0


def test_a_measured_surface_becomes_a_deformed_label_map(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    body = block_mesh(4, side=80.0)
    case, cloud, toml, out = (
        tmp_path / name for name in ("case.vtu", "c.csv", "m.toml", "labels.nii")
    )
    write_mesh(case, body)
    x, y = np.meshgrid(*2 * [np.linspace(0.0, 80.0, 16)])
    flat = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 74.0)])
    np.savetxt(cloud, flat, delimiter=",")
    toml.write_text('[materials.brain]\ntissue = "brain-ogden"\n')
    how = ("--skull", "sliding", "--materials", toml, "--as", "labels", "-o", out)
    run("register", case, "--surface", cloud, *how)
    said = capsys.readouterr().out
    assert "mm at most (90% of cases)" in said
    labels = read_image(out)
    assert set(np.unique(labels.data)) == {0, 1, 2}
    highest = labels.grid.to_world(np.argwhere(labels.data))[:, 2].max()
    assert 72.0 < highest < 78.0


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        (
            ("--target", "m.csv", "-o", "o.vtu"),
            "--target is of no use without --points",
        ),
        (("-o", "o.vtu"), "give --points"),
        (("--landmarks", "out.csv", "-o", "o.vtu"), "landmarks must lie inside"),
        (
            ("--points", "m.csv", "--surface-noise-mm", 1, "-o", "o.vtu"),
            "without --surface",
        ),
        (("--points", "m.csv", "--noise-mm", 0, "-o", "o.vtu"), "noise_mm"),
        (("--points", "m.csv", "-o", "o.stl"), "written as .vtu"),
        (("--surface", "m.csv", "-o", "o.vtu"), "both ends of pairs"),
        (
            ("--points", "m.csv", "--skull", "loose", "-o", "o.vtu"),
            "'fixed', 'sliding'",
        ),
        (("--points", "m.csv", "--image", "no.nii", "-o", "o.nii"), "no such file"),
        (("--points", "m.csv", "--image", "no.nii", "-o", "o.vtu"), "--image is for"),
    ],
)
def test_register_says_what_is_wrong(
    words: tuple[str, ...],
    hint: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    body = block_mesh(2, side=80.0)
    write_mesh("case.vtu", body)
    top = body.points[body.point_set("loaded")]
    np.savetxt("m.csv", np.hstack([top, top]), delimiter=",")
    np.savetxt("out.csv", np.full((1, 6), 200.0), delimiter=",")
    with pytest.raises(AssertionError, match="2"):
        run("register", "case.vtu", *words)
    said = capsys.readouterr().err
    assert hint in said and "Traceback" not in said
    assert not (tmp_path / "o.vtu").exists()


def test_a_mistake_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(AssertionError, match="2"):
        run(
            "warp",
            tmp_path / "absent.nii",
            tmp_path / "x.vtu",
            "-o",
            tmp_path / "y.nii",
        )
    said = capsys.readouterr().err
    assert "no such file" in said and "Traceback" not in said


def test_what_is_not_ok_says_so_in_the_exit_code_the_file_and_the_next_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Three points do not tell how a body moved; the displacement is written still."""
    body = block_mesh(4, side=80.0)
    case, csv, out = (tmp_path / name for name in ("case.vtu", "m.csv", "out.vtu"))
    write_mesh(case, body)
    top = body.points[body.point_set("loaded")][[0, 5, 20]]
    np.savetxt(csv, np.hstack([top, top - [0, 0, 4]]), delimiter=",")
    register = ("register", case, "--points", csv, "--noise-mm", 0.5)
    run(*register, "-o", out, code=3)
    said = capsys.readouterr()
    assert "too few points: the measured points are too few" in said.out
    assert "3 places were measured (at least 6)" in said.err
    fields = pv.read(out).field_data
    assert list(fields["status"]) == ["too few points"]
    assert "3 places were measured (at least 6)" in list(fields["reasons"])
    run(*register, "-o", tmp_path / "field.nii", code=3)
    header = nib.load(tmp_path / "field.nii").header
    assert b"too few points" in header["descrip"].item()
    image = Image(np.ones((8, 8, 8)), np.diag([10.0, 10.0, 10.0, 1.0]))
    write_image(tmp_path / "t1.nii", image)
    (tmp_path / "plan.csv").write_text("10,10,70\n20,10,70\n")
    t1, u = tmp_path / "t1.nii", tmp_path / "u.nii"
    for made, words in {
        "moved.nii": ("warp", t1, out),
        "moved.csv": ("warp", tmp_path / "plan.csv", out),
        "back.nii": ("warp", t1, out, "--back"),
        "deviation.nii": ("uncertainty", out, t1, "--wrong", u),
    }.items():
        run(*words, "-o", tmp_path / made, code=3)
        said = capsys.readouterr()
        assert "a displacement that is not ok: too few points: 3 places" in said.err
        assert f"{out} is not ok, nor what is made of it: too few points" in said.err
        assert (tmp_path / made).is_file()


def test_a_status_without_reasons_counts_and_none_at_all_does_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    body = block_mesh(2, side=40.0)
    image = Image(np.ones((8, 8, 8)), np.diag([10.0, 10.0, 10.0, 1.0]))
    write_image(tmp_path / "t1.nii", image)
    fields = {"displacement_mm": np.full((body.n_points, 3), 1.0)}
    for status, code in {"ok": 0, "repaired": 0, "": 0, "too few points": 3}.items():
        notes = {"status": (status,) if status else (), "reasons": ()}
        write_prediction(tmp_path / "u.vtu", body, fields, notes=notes)
        words = (tmp_path / "t1.nii", tmp_path / "u.vtu", "-o", tmp_path / "w.nii")
        run("warp", *words, code=code)
        assert ("not ok" in capsys.readouterr().err) == (code == 3)


@pytest.mark.parametrize("scale", [1e-3, 0.1])
def test_a_surface_in_other_units_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], scale: float
) -> None:
    """All of it lies together, and near a body that holds the origin."""
    block = block_mesh(4, side=60.0)
    body = replace(block, points=block.points - 30.0)
    write_mesh(tmp_path / "case.vtu", body)
    top = body.points[body.point_set("loaded")] - [0, 0, 2]
    np.savetxt(tmp_path / "s.csv", scale * top, delimiter=",")
    words = ("--surface", tmp_path / "s.csv", "-o", tmp_path / "out.vtu")
    run("register", tmp_path / "case.vtu", *words, code=2)
    said = capsys.readouterr()
    assert "measured surface" in said.err and " ok: " not in said.out
    assert not (tmp_path / "out.vtu").exists()


def test_register_takes_a_folder_for_its_page(tmp_path: Path) -> None:
    body = block_mesh(4, side=80.0)
    write_mesh(tmp_path / "case.vtu", body)
    top = body.points[body.point_set("loaded")]
    depth = 6.0 * np.exp(-((top - [40.0, 40.0, 80.0]) ** 2).sum(1) / (2 * 25.0**2))
    dent = depth[:, None] * [0.0, 0.0, 1.0]
    np.savetxt(tmp_path / "m.csv", np.hstack([top, top - dent]), delimiter=",")
    words = ("--points", tmp_path / "m.csv", "--report", tmp_path / "page")
    run("register", tmp_path / "case.vtu", *words, "-o", tmp_path / "u.vtu")
    assert (tmp_path / "page" / "report.html").is_file()

"""The command refuses in one line what it cannot use, before and after reading."""

import sys
from pathlib import Path

import nibabel as nib
import numpy as np
import pytest

from physgnn.cli import main

RANDOM = np.random.default_rng(0).random((30, 30, 30)).astype(np.float32)


def saved(path: Path, data: np.ndarray) -> str:
    nib.save(nib.Nifti1Image(data, np.diag([4.0, 4.0, 4.0, 1.0])), path)
    return str(path)


def refused(
    arguments: list[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> str:
    monkeypatch.setattr(sys, "argv", ["physgnn", "segment", *arguments])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    line = capsys.readouterr().err.strip().splitlines()[-1]
    assert line.startswith("physgnn: ")
    return line


COLOURS = np.zeros((30, 30, 30), dtype=[("R", "u1"), ("G", "u1"), ("B", "u1")])


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (np.zeros((30, 30, 30), np.float32), "contrast"),
        ((RANDOM > 0.5).astype(np.int16), "label map"),
        (np.stack([RANDOM, RANDOM], axis=-1), "three axes"),
        (COLOURS, "colour"),
        (np.where(RANDOM > 0.8, 30.0, -1000.0).astype(np.float32), "CT"),
        (RANDOM[:3], "8 voxels"),
    ],
    ids=["empty", "labels", "4-D", "colours", "CT", "tiny"],
)
def test_what_is_no_scan(
    data: np.ndarray,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    scan = saved(tmp_path / "scan.nii.gz", data)
    out = tmp_path / "seg.nii.gz"
    line = refused([scan, "-o", str(out)], monkeypatch, capsys)
    assert message in line
    assert "scan.nii.gz" in line
    assert sorted(tmp_path.iterdir()) == [tmp_path / "scan.nii.gz"]


@pytest.mark.parametrize(
    ("extra", "message"),
    [
        (["--tumour-labels", "1"], "--tumour-labels is of no use without --tumour"),
        (["--tumour", "labels.nii.gz"], "must be named"),
        (["--tumour", "labels.nii.gz", "--tumour-labels", "7"], "no voxel has"),
        (["--tumour", "labels.nii.gz", "--tumour-labels", "a"], "such as 1"),
        (["--tumour", "points.csv"], "one point"),
        (["--picture", "seg.jpg"], "written as .png"),
    ],
)
def test_options_that_cannot_be_used(
    extra: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    saved(Path("scan.nii.gz"), RANDOM)
    saved(Path("labels.nii.gz"), np.rint(2 * RANDOM).astype(np.int16))
    Path("points.csv").write_text("x,y,z\n", "utf-8")
    arguments = ["scan.nii.gz", "-o", "seg.nii.gz", *extra]
    assert message in refused(arguments, monkeypatch, capsys)
    assert not Path("seg.nii.gz").exists()


def test_mesh_names_segment_for_a_scan(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    scan = saved(tmp_path / "t1.nii.gz", RANDOM)
    monkeypatch.setattr(
        sys, "argv", ["physgnn", "mesh", scan, "-o", str(tmp_path / "case.vtu")]
    )
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    assert "physgnn segment" in capsys.readouterr().err

"""The commands of the page of formats, run as shown there."""

import shlex
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest

from dicom_files import write_series
from meshes import block_mesh
from physgnn.cli import main
from physgnn.geometry.image import Image
from physgnn.io import read_mesh, write_prediction
from physgnn.io.medical.images.formats import read_image, write_image

BODY = block_mesh(3, side=110.0)
AFFINE = np.diag([-5.0, 5.0, 5.0, 1.0])
AFFINE[:3, 3] = [112.0, -2.0, -2.0]
UID = "1.2.840.113619.2.312"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    still = np.zeros(BODY.points.shape)
    write_prediction("shift.vtu", BODY, {"displacement_mm": still})
    write_prediction("case.vtu", BODY, {"displacement_mm": still})
    image = Image(np.random.default_rng(0).integers(0, 900, size=(24, 23, 22)), AFFINE)
    for name in ("t1.nrrd", "t1.mgz"):
        write_image(name, image)
    write_series(Path("scan"), image, uid=UID)
    write_series(Path("scan"), image, uid="1.2.3", description="T2", prefix="T2")
    made = meshio.Mesh(
        BODY.points,
        [("tetra", BODY.cells)],
        cell_data={"gmsh:physical": [BODY.region + 1]},
        field_data={"brain": np.array([1, 3]), "tumor": np.array([2, 3])},
    )
    made.cell_data["gmsh:geometrical"] = made.cell_data["gmsh:physical"]
    meshio.write("existing.msh", made, file_format="gmsh22")
    return tmp_path


def run(command: str, monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.setattr(sys, "argv", shlex.split(command))
    try:
        main()
    except SystemExit as end:
        return int(end.code or 0)
    return 0


@pytest.mark.parametrize(
    ("command", "made"),
    [
        ("warp t1.nrrd shift.vtu -o t1-deformed.nrrd", "t1-deformed.nrrd"),
        ("warp t1.mgz shift.vtu -o t1-deformed", "t1-deformed.mgz"),
        (f"warp scan/ shift.vtu --series {UID} -o out.nii.gz", "out.nii.gz"),
        (f"warp scan/{UID} shift.vtu -o out.nii.gz", "out.nii.gz"),
    ],
)
def test_warp(
    command: str,
    made: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run(f"physgnn {command}", monkeypatch) == 0
    assert made in capsys.readouterr().out
    assert sorted(read_image(folder / made).data.shape) == [22, 23, 24]


def test_mesh_takes_over_a_mesh(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run("physgnn mesh existing.msh -o taken.vtu", monkeypatch) == 0
    assert "region 1 'brain' → brain" in capsys.readouterr().err
    assert read_mesh(folder / "taken.vtu").n_points == BODY.n_points


def test_what_is_wrong_is_one_line(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    del folder
    for command, hint in (
        ("warp scan shift.vtu -o out.nii.gz", "'T1 MPRAGE'"),
        ("warp t1.nrrd shift.vtu -o out.dcm", "an image is written as"),
        ("mesh t1.nrrd -o out.vtu", "see 'physgnn segment'"),
        ("mesh existing.msh --target-points 9 -o out.vtu", "keeps its cells"),
        ("mesh t1.nrrd --series 1.2 -o out.vtu", "only a folder of DICOM"),
    ):
        assert run(f"physgnn {command}", monkeypatch) == 2, command
        said = capsys.readouterr().err
        assert hint in said and "Traceback" not in said, said
    assert not list(Path().glob("out*"))

"""A tumour that was taken out: no tissue in images and plans."""

from pathlib import Path

import numpy as np
import pytest

import physgnn as pg
from meshes import BOX_MM, brain_in_a_box
from physgnn.cli import main
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import read_mesh, write_mesh
from physgnn.io.medical.images.formats import read_image, write_image
from physgnn.io.vtk.prediction_file import read_removed
from physgnn.registration.removed_region import resected


@pytest.fixture(scope="module")
def brain() -> TetMesh:
    return brain_in_a_box()


@pytest.fixture(scope="module")
def case(brain: TetMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("resected")
    write_mesh(folder / "case.vtu", brain)
    top = brain.points[(brain.points[:, 2] == BOX_MM)]
    top = top[(top[:, :2] > 5).all(axis=1) & (top[:, :2] < 55).all(axis=1)]
    rows = np.hstack([top, top - np.array([0.0, 0.0, 2.0])])
    np.savetxt(folder / "pairs.csv", rows, delimiter=",")
    return folder


@pytest.fixture(scope="module")
def shift(case: Path) -> Path:
    out = case / "shift.vtu"
    found = pg.register(
        case / "case.vtu", out, points=case / "pairs.csv", remove="tumour"
    )
    assert found.prediction.displacement[:, 2].min() < -1.0
    return out


def test_the_file_holds_what_is_left_and_what_is_gone(
    brain: TetMesh, shift: Path
) -> None:
    found = resected(brain, "tumour")
    mesh, removed = read_mesh(shift), read_removed(shift)
    assert mesh.content_hash == found.remaining.content_hash
    assert removed is not None
    np.testing.assert_array_equal(removed.points, found.removed.points)
    np.testing.assert_array_equal(removed.cells, found.removed.cells)


def test_images_show_no_tissue_where_it_was_removed(case: Path, shift: Path) -> None:
    affine = np.diag([2.0, 2.0, 2.0, 1.0])
    bright = Image(np.full((31, 31, 31), 100.0, dtype=np.float32), affine)
    write_image(case / "t1.nii.gz", bright)
    pg.warp(case / "t1.nii.gz", shift, case / "after.nii.gz")
    after = read_image(case / "after.nii.gz").data
    pg.warp(case / "t1.nii.gz", shift, case / "back.nii.gz", back=True)
    back = read_image(case / "back.nii.gz").data
    assert after[15, 15, 20] == 0 and back[15, 15, 20] == 0  # (30, 30, 40) mm
    assert after[15, 15, 8] == back[15, 15, 8] == 100
    gone = 8.0 * (back == 0).sum()  # mm³; back is on the voxels of the rest state
    assert gone == pytest.approx(20.0**3, rel=0.35)


def test_points_of_a_plan_in_removed_tissue_are_named(case: Path, shift: Path) -> None:
    plan = case / "plan.fcsv"
    plan.write_text(
        "# Markups fiducial file version = 4.11\n# CoordinateSystem = RAS\n"
        "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
        "1,30,30,40,0,0,0,1,1,1,0,target,,\n2,30,30,20,0,0,0,1,1,1,0,deep,,\n"
    )
    said: list[str] = []
    pg.warp(plan, shift, case / "moved.fcsv", log=said.append)
    (line,) = [line for line in said if "removed" in line]
    assert "target" in line and "deep" not in line


def test_on_the_command_line_a_landmark_inside_is_one_line(
    case: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    np.savetxt(case / "inside.csv", [[30, 30, 41, 30, 30, 40]], delimiter=",")
    mesh, inside = str(case / "case.vtu"), str(case / "inside.csv")
    asked = ["register", mesh, "--remove", "tumour", "--landmarks", inside]
    monkeypatch.setattr("sys.argv", ["physgnn", *asked, "-o", str(case / "no.vtu")])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 2
    said = capsys.readouterr().err
    assert "landmarks in the tumour that was removed" in " ".join(said.split())
    assert not (case / "no.vtu").exists()


def test_a_plan_of_removed_tissue_alone_has_no_place(
    case: Path, shift: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("physgnn.imaging.field.SHORTEST_FADE_MM", 1.0)
    monkeypatch.setattr("physgnn.imaging.field.FADE_PER_DISPLACEMENT", 1.0)
    for text, said in (
        ("30,30,40\n", r"core\.csv: .*1 point, all in tissue that was removed"),
        ("30,30,40\n500,0,0\n", r"core\.csv: mesh and points do not meet"),
    ):
        (case / "core.csv").write_text(text)
        with pytest.raises(InputError, match=said):
            pg.warp(case / "core.csv", shift, case / "moved.csv")
    assert not (case / "moved.csv").exists()

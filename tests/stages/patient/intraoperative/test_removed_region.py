"""A tumour that was taken out: named landmarks, and no tissue in images and plans."""

from pathlib import Path

import numpy as np
import pytest

import physgnn as pg
from meshes import block_mesh
from physgnn.cli import main
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.geometry.measured import Landmarks, PointPairs, SurfacePoints
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import read_mesh, write_mesh
from physgnn.io.medical.images.formats import read_image, write_image
from physgnn.io.vtk.prediction_file import read_removed
from physgnn.registration.removed_region import resected

SIDE = 60.0


@pytest.fixture(scope="module")
def brain() -> TetMesh:
    """A block in a box, open at the top, with a tumour near the top."""
    block = block_mesh(6, side=SIDE)
    x, y, z = block.points.T
    wall = (z == 0) | np.isin(x, [0, SIDE]) | np.isin(y, [0, SIDE])
    centres = block.points[block.cells].mean(axis=1)
    tumour = (np.abs(centres - [30, 30, 40]) < 10).all(axis=1)
    return TetMesh(
        block.points,
        block.cells,
        tumour.astype(np.int32),
        {"fixed": np.flatnonzero(wall)},
    )


@pytest.fixture(scope="module")
def case(brain: TetMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("resected")
    write_mesh(folder / "case.vtu", brain)
    top = brain.points[(brain.points[:, 2] == SIDE)]
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


def test_the_wall_is_a_set_and_what_is_gone_is_kept(brain: TetMesh) -> None:
    found = resected(brain, "tumour")
    assert (found.remaining.region == 0).all() and (found.removed.region == 1).all()
    volume = found.remaining.cell_volumes.sum() + found.removed.cell_volumes.sum()
    assert volume == pytest.approx(SIDE**3)
    wall = found.remaining.points[found.remaining.point_set("cavity")]
    assert (np.abs(wall - [30, 30, 40]).max(axis=1) == 10).all()
    with pytest.raises(InputError, match=r"brain, tumour \(got 'ventricle'\)"):
        resected(brain, "ventricle")


def test_the_brain_itself_is_not_removed(brain: TetMesh) -> None:
    for name in ("brain", "0"):
        with pytest.raises(InputError, match="must name a part of the brain"):
            resected(brain, name)


def test_landmarks_of_removed_tissue_are_named(brain: TetMesh) -> None:
    found = resected(brain, "tumour")
    places = np.array([[30.0, 30, 42], [30, 30, 20], [30, 30, 49.5], [10, 10, 10]])
    names = ("core", "below", "rim", "corner")
    with pytest.raises(InputError) as refused:
        found.check_measured([Landmarks(places, places, names)])
    assert "landmarks in the tumour" in str(refused.value)
    assert "'core' (8.0 mm from the wall)" in str(refused.value)
    assert not any(name in str(refused.value) for name in ("below", "rim", "corner"))
    found.check_measured([Landmarks(places[1:], places[1:])])
    found.check_measured([SurfacePoints(np.tile(places, (3, 1)))])
    with pytest.raises(InputError, match="points in the tumour"):
        found.check_measured([PointPairs(places, places)])


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

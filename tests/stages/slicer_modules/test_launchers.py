"""The launchers, run as 3D Slicer runs them: temporary files, flags, tags, results.

Slicer writes every node to a file of the first extension, in its own axes, runs the
launcher in the environment of its own Python, and reads back what it asked for.
"""

import json
import os
import re
import stat
import subprocess
from collections.abc import Callable
from pathlib import Path

import nibabel as nib
import numpy as np
import pytest
import pyvista as pv
import SimpleITK as sitk
from ctk_cli import CLIModule, listCLIExecutables

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_surface
from physgnn.geometry.image import Image, LabelVolume
from physgnn.geometry.meshing import tetgen_process
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import read_mesh, write_mesh
from physgnn.io.medical.images.formats import write_image
from physgnn.io.vtk.prediction_file import read_displacement
from physgnn.stages import register, slicer

SINKS_MM = 4.0
FCSV = """# Markups fiducial file version = 5.0
# CoordinateSystem = LPS
# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID
"""

Launch = Callable[..., tuple[dict[str, str], str]]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("slicer") / "my modules"  # a space in its name
    slicer(made)
    return made


@pytest.fixture
def launch(folder: Path, tmp_path: Path) -> Launch:
    """Run a module as Slicer does; return what it found, and what it printed."""

    def run(name: str, code: int = 0, **flags: object) -> tuple[dict[str, str], str]:
        results = tmp_path / "results.txt"
        results.unlink(missing_ok=True)
        command = [str(folder / name), "--returnparameterfile", str(results)]
        for flag, value in flags.items():
            if value is True:
                command.append(f"--{flag}")
            else:
                command += [f"--{flag}", str(value)]
        of_slicer = {"PYTHONHOME": "/opt/Slicer/lib/Python", "PYTHONPATH": "/nowhere"}
        done = subprocess.run(
            command,
            env={**os.environ, **of_slicer},
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == code, done.stderr
        lines = results.read_text().splitlines() if results.exists() else []
        pairs = [line.partition(" = ") for line in lines]
        return {key: value for key, _, value in pairs}, done.stdout + done.stderr

    return run


@pytest.fixture
def block(tmp_path: Path) -> tuple[Path, TetMesh]:
    mesh = block_mesh(3, side=80.0)
    write_mesh(tmp_path / "case.vtu", mesh)
    return tmp_path / "case.vtu", mesh


def markups(path: Path, points: np.ndarray) -> Path:
    """A list of points as Slicer writes it, LPS."""
    rows = [
        f"vtkMRMLMarkupsFiducialNode_{i},{-x},{-y},{z},0,0,0,1,1,1,0,P-{i},,"
        for i, (x, y, z) in enumerate(points)
    ]
    path.write_text(FCSV + "\n".join(rows) + "\n")
    return path


def fractions(printed: str) -> list[float]:
    found = re.findall(r"<filter-progress>([\d.]+)</filter-progress>", printed)
    return [float(text) for text in found]


def test_slicer_finds_executables_that_describe_themselves(folder: Path) -> None:
    found = {Path(path).name: path for path in listCLIExecutables(str(folder))}
    assert set(found) >= {
        "PhysGNNMesh",
        "PhysGNNRegister",
        "PhysGNNWarp",
        "PhysGNNPredict",
    }
    for name, path in found.items():
        assert Path(path).stat().st_mode & stat.S_IXUSR
        described = CLIModule(path)  # runs it with --xml
        beside = CLIModule(f"{path}.xml")
        assert described.title == beside.title
        assert [p.name for p in described.parameters()] == [
            p.name for p in beside.parameters()
        ], name


def test_register_moves_what_slicer_shows(
    launch: Launch, block: tuple[Path, TetMesh], tmp_path: Path
) -> None:
    case, mesh = block
    top = mesh.points[mesh.point_set("loaded")]
    found, printed = launch(
        "PhysGNNRegister",
        mesh=case,
        points=markups(tmp_path / "before.fcsv", top),
        target=markups(tmp_path / "after.fcsv", top - [0.0, 0.0, SINKS_MM]),
        noise_mm=0.5,
        skull="fixed",
        shift=tmp_path / "shift.vtu",
        transform=tmp_path / "shift.h5",
        surfaces=tmp_path / "surfaces.vtp",
    )
    assert float(found["misfit_mm"]) < 1.0
    assert found["status"]
    assert found["reason"]
    assert found["bound_mm"] == "" or float(found["bound_mm"]) > 0
    part = fractions(printed)
    assert part[0] == 0.0
    assert part[-1] == 1.0
    assert part == sorted(part)
    assert len(part) == 4  # begun, registered, transform written, done
    assert printed.count("<filter-start>") == printed.count("<filter-end>") == 1

    rest, u = read_displacement(tmp_path / "shift.vtu")
    loaded = mesh.point_set("loaded")
    assert u[loaded, 2].mean() == pytest.approx(-SINKS_MM, abs=1.0)
    # the transform is ITK's: from where the brain is now, LPS, back to the scan
    transform = sitk.ReadTransform(str(tmp_path / "shift.h5"))
    middle = loaded[np.linalg.norm(rest.points[loaded] - [40, 40, 80], axis=1).argmin()]
    now = (rest.points[middle] + u[middle] - [0, 0, 3]) * [-1, -1, 1]
    back = np.array(transform.TransformPoint(now.tolist()))
    assert back[2] - now[2] == pytest.approx(-u[middle, 2], abs=1.0)
    assert np.abs(back[:2] - now[:2]).max() < 1.5
    surfaces = pv.read(tmp_path / "surfaces.vtp")
    assert surfaces.field_data["SPACE"] == ["RAS"]  # Slicer takes models for LPS
    lowest = (rest.points + u)[:, 2].max()
    assert surfaces.points[:, 2].max() == pytest.approx(lowest, abs=1e-3)


def test_the_form_of_register_has_its_options(
    launch: Launch, block: tuple[Path, TetMesh], tmp_path: Path
) -> None:
    case, mesh = block
    top = mesh.points[mesh.point_set("loaded")]
    files = {
        "points": markups(tmp_path / "before.fcsv", top),
        "target": markups(tmp_path / "after.fcsv", top - [0.0, 0.0, SINKS_MM]),
    }
    bone = np.array([[-5.0, 10, 70], [-5, 70, 75], [85, 40, 75], [40, 85, 70]])
    files["bone"] = markups(tmp_path / "bone.fcsv", bone)
    files["bone_target"] = markups(tmp_path / "now.fcsv", bone + 0.1)
    options = {"rigid_offset": True, "causes": "none"}
    out = tmp_path / "shift.vtu"
    found, _ = launch(
        "PhysGNNRegister", mesh=case, shift=out, remove="", **files, **options
    )
    assert found["offset"].endswith("corrected")
    assert found["bone"].startswith("4 bone points")
    register(case, tmp_path / "theirs.vtu", **files, **options)
    assert out.read_bytes() == (tmp_path / "theirs.vtu").read_bytes()
    found, said = launch(
        "PhysGNNRegister", 2, mesh=case, shift=out, remove="nothing", **files
    )
    assert found["status"].startswith("failed") and "nothing" in said


def test_landmarks_a_whole_surface_and_another_space_go_through_the_form(
    launch: Launch, block: tuple[Path, TetMesh], tmp_path: Path
) -> None:
    case, mesh = block
    inside = np.array([[x, y, z] for x in (25, 55) for y in (25, 55) for z in (45, 65)])
    elsewhere = np.array([3.0, -7.0, 11.0])  # where the tracker's origin lies, RAS
    sitk.WriteTransform(
        sitk.TranslationTransform(3, (-elsewhere * [-1, -1, 1]).tolist()),
        str(tmp_path / "space.h5"),
    )
    moved = inside - [0.0, 0.0, 1.0] * inside[:, 2:] * SINKS_MM / 80
    whole = boundary_surface(mesh)
    down = whole.points - [0.0, 0.0, 1.0] * whole.points[:, 2:] * SINKS_MM / 80
    faces = np.column_stack([np.full(len(whole.faces), 3), whole.faces])
    model = pv.PolyData(down - elsewhere, faces.ravel())
    model.field_data["SPACE"] = ["RAS"]
    model.save(tmp_path / "whole.vtp")
    files = {
        "landmarks": markups(tmp_path / "before.fcsv", inside - elsewhere),
        "landmarks_target": markups(tmp_path / "after.fcsv", moved - elsewhere),
        "whole_surface": tmp_path / "whole.vtp",
        "initial_transform": tmp_path / "space.h5",
    }
    out = tmp_path / "shift.vtu"
    found, _ = launch("PhysGNNRegister", mesh=case, shift=out, noise_mm=0.5, **files)
    assert float(found["misfit_mm"]) < 1.0
    rest, u = read_displacement(out)
    expected = -rest.points[:, 2] * SINKS_MM / 80
    assert np.abs(u[:, 2] - expected).mean() < 0.5


def test_points_in_either_system_are_the_same_points(
    launch: Launch, block: tuple[Path, TetMesh], tmp_path: Path
) -> None:
    case, mesh = block
    top = mesh.points[mesh.point_set("loaded")]
    moved = top - [0.0, 0.0, SINKS_MM]
    shifts = []
    for system, sign in (("LPS", [1, 1, 1]), ("RAS", [-1, -1, 1])):
        files = []
        for name, points in (("before", top), ("after", moved)):
            path = markups(tmp_path / f"{name}-{system}.fcsv", points * sign)
            path.write_text(path.read_text().replace("LPS", system))
            files.append(path)
        out = tmp_path / f"{system}.vtu"
        launch(
            "PhysGNNRegister", mesh=case, points=files[0], target=files[1], shift=out
        )
        shifts.append(read_displacement(out)[1])
    np.testing.assert_allclose(shifts[0], shifts[1], atol=1e-9)


def test_warp_deforms_a_volume(
    launch: Launch, block: tuple[Path, TetMesh], tmp_path: Path
) -> None:
    _, mesh = block
    from physgnn.io.vtk.vtu import write_prediction

    u = np.zeros_like(mesh.points)
    u[:, 2] = -SINKS_MM * mesh.points[:, 2] / 80.0
    notes = {"status": ["offset not told"], "reasons": ["it may be a brain that sank"]}
    fields = {"displacement_mm": u}
    write_prediction(tmp_path / "shift.vtu", mesh, fields, notes=notes)
    heights = np.arange(-20.0, 100.0, 4.0)
    # not whole numbers: those would be taken for labels
    ramp = np.broadcast_to(heights + 0.25, (30, 30, 30)).astype(np.float32)
    affine = np.diag([4.0, 4.0, 4.0, 1.0])
    affine[:3, 3] = -20.0
    write_image(tmp_path / "t1.nii.gz", Image(ramp, affine))
    found, printed = launch(
        "PhysGNNWarp",
        image=tmp_path / "t1.nii.gz",
        prediction=tmp_path / "shift.vtu",
        deformed=tmp_path / "moved.nii.gz",
        transform=tmp_path / "t.h5",
        jacobian=tmp_path / "detF.nii.gz",
    )
    assert found["status"] == "offset not told"
    assert found["reason"] == "it may be a brain that sank"
    assert fractions(printed)[-1] == 1.0
    moved = nib.load(tmp_path / "moved.nii.gz")
    np.testing.assert_allclose(moved.affine, affine, atol=1e-4)
    # what was at height h is at h (1 - 4 / 80)
    now = moved.get_fdata()[15, 15, 15]
    assert now == pytest.approx(heights[15] / (1 - SINKS_MM / 80.0) + 0.25, abs=0.3)
    inside = nib.load(tmp_path / "detF.nii.gz").get_fdata()[15, 15, 15]
    assert inside == pytest.approx(1 - SINKS_MM / 80.0, abs=0.02)
    assert sitk.ReadTransform(str(tmp_path / "t.h5")).GetDimension() == 3


def test_predict_pushes_at_markups(launch: Launch, tmp_path: Path) -> None:
    from physgnn.serving.scene.viewed import view

    exposed = view(None).exposed
    middle = np.linalg.norm(
        exposed.points - exposed.points.mean(axis=0), axis=1
    ).argsort()[:8]
    found, printed = launch(
        "PhysGNNPredict",
        points=markups(tmp_path / "push.fcsv", exposed.points[middle]),
        force_n="-0.3,-0.2,-0.4",
        shift=tmp_path / "shift.vtu",
        transform=tmp_path / "shift.h5",
    )
    _, u = read_displacement(tmp_path / "shift.vtu")
    pushed = u[np.linalg.norm(u, axis=1).argmax()]
    assert pushed @ [-0.3, -0.2, -0.4] > 0
    assert set(found) == {"status", "reason", "bound_mm"}
    assert fractions(printed)[-1] == 1.0
    # whatever the status: a file that was written is shown


@pytest.mark.skipif(not tetgen_process.available(), reason="needs the tetgen extra")
def test_mesh_takes_a_label_map_and_a_craniotomy(
    launch: Launch, tmp_path: Path
) -> None:
    x = np.moveaxis(np.indices((26, 26, 26)), 0, -1) * 4.0 - 50.0
    ball = np.linalg.norm(x, axis=-1) < 40
    affine = np.diag([4.0, 4.0, 4.0, 1.0])
    affine[:3, 3] = -50.0
    write_image(tmp_path / "seg.nii.gz", LabelVolume(ball * 1, affine))
    found, _ = launch(
        "PhysGNNMesh",
        segmentation=tmp_path / "seg.nii.gz",
        labels="mask",
        craniotomy=markups(tmp_path / "c.fcsv", np.array([[28.0, 28.0, 0.0]])),
        radius_mm=30,
        target_points=1200,
        mesh=tmp_path / "case.vtu",
        surfaces=tmp_path / "surfaces.vtp",
    )
    mesh = read_mesh(tmp_path / "case.vtu")
    assert found == {"status": "ok", "points": str(mesh.n_points)}
    fixed = mesh.points[mesh.point_set("fixed")]
    far = np.linalg.norm(fixed - [28.0, 28.0, 0.0], axis=1)
    assert far.min() >= 30.0
    surfaces = pv.read(tmp_path / "surfaces.vtp")
    assert np.linalg.norm(surfaces.points, axis=1).max() == pytest.approx(40, abs=4)


def test_what_failed_is_among_the_results(
    launch: Launch, block: tuple[Path, TetMesh], tmp_path: Path
) -> None:
    bad = tmp_path / "bad.fcsv"
    bad.write_text("no markups\n")
    found, _ = launch(
        "PhysGNNRegister", code=2, mesh=block[0], points=bad, shift=tmp_path / "x.vtu"
    )
    assert found["status"].startswith("failed: ")
    assert "CoordinateSystem" in found["status"]


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="name another folder"):
        slicer(tmp_path / "file")


def test_a_load_file_will_do(launch: Launch, tmp_path: Path) -> None:
    from physgnn.serving.scene.viewed import view

    point = view(None).exposed.points[0].tolist()
    load = {"points": [point], "forces_n": [[0.0, 0.0, -0.1]]}
    (tmp_path / "load.json").write_text(json.dumps(load))
    out = tmp_path / "s.vtp"
    found, _ = launch(
        "PhysGNNPredict", load=tmp_path / "load.json", points="", surfaces=out
    )
    assert found["status"]
    assert out.stat().st_size > 0

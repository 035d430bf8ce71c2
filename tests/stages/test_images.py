from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
import SimpleITK as sitk

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.geometry.meshing import tetgen_process
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_mesh, write_prediction
from physgnn.io.medical.images.formats import read_image, read_segmentation, write_image
from physgnn.io.vtk.prediction_file import read_displacement
from physgnn.stages.patient.images.warping import warp
from physgnn.stages.patient.intraoperative.registration import register
from physgnn.stages.patient.preoperative.meshing import mesh
from physgnn.stages.patient.preoperative.segmentation import mesh_segmentation

needs_tetgen = pytest.mark.skipif(
    not tetgen_process.available(), reason="meshing needs the tetgen extra"
)


@pytest.fixture
def labels() -> LabelVolume:
    """A ball of brain with a tumour and a ventricle, LPS, 3 mm voxels."""
    affine = np.diag([-3.0, -3.0, 3.0, 1.0])
    affine[:3, 3] = [50, 60, -10]
    x = np.moveaxis(np.indices((32, 32, 32)), 0, -1) * 3.0
    data = (np.linalg.norm(x - 46, axis=-1) < 38).astype(np.int32)
    data[np.linalg.norm(x - [46, 46, 62], axis=-1) < 11] = 4
    data[np.linalg.norm(x - [46, 46, 30], axis=-1) < 11] = 6
    return LabelVolume(data, affine)


@needs_tetgen
def test_volumes_of_mesh_and_labels_agree(labels: LabelVolume, tmp_path: Path) -> None:
    write_image(tmp_path / "seg.nii.gz", labels)
    said: list[str] = []
    mesh = mesh_segmentation(
        tmp_path / "seg.nii.gz",
        "brain=1,tumour=4,ventricle=6",
        target_points=2000,
        log=said.append,
    )
    assert mesh.n_points == pytest.approx(2000, rel=0.1)
    for region, label in ((0, 1), (1, 4), (2, 6)):
        wanted = (labels.data == label).sum() * 27.0
        inside = mesh.region == region
        assert mesh.cell_volumes[inside].sum() == pytest.approx(wanted, rel=0.02)
        middle = labels.grid.to_world(np.argwhere(labels.data == label)).mean(axis=0)
        centres = mesh.points[mesh.cells[inside]].mean(axis=1)
        np.testing.assert_allclose(
            np.average(centres, axis=0, weights=mesh.cell_volumes[inside]),
            middle,
            atol=0.5,
        )
    assert sum("labels" in line and "apart on average" in line for line in said) == 3


@needs_tetgen
def test_a_brain_mask_completes_a_map_of_tumours(
    labels: LabelVolume, tmp_path: Path
) -> None:
    tumour = LabelVolume(np.where(labels.data == 4, 3, 0), labels.affine)
    write_image(tmp_path / "seg.nii", tumour)
    write_image(tmp_path / "t1.nii", Image(labels.data * 7.5, labels.affine))
    mesh = mesh_segmentation(
        tmp_path / "seg.nii",
        "brats",
        brain_mask=tmp_path / "t1.nii",
        target_points=1500,
    )
    assert set(mesh.region) == {0, 1}
    whole = (labels.data > 0).sum() * 27.0
    assert mesh.cell_volumes.sum() == pytest.approx(whole, rel=0.02)
    write_image(tmp_path / "small.nii", Image(np.ones((4, 4, 4)), labels.affine))
    with pytest.raises(InputError, match="voxels of the label map"):
        mesh_segmentation(
            tmp_path / "seg.nii", "brats", brain_mask=tmp_path / "small.nii"
        )


def test_warp_writes_all_that_is_asked(block: TetMesh, tmp_path: Path) -> None:
    affine = np.diag([0.5, 0.5, 0.5, 1.0])
    affine[:3, 3] = -5.0
    x = np.moveaxis(np.indices((40, 40, 40)), 0, -1) * 0.5 - 5.0
    ball = np.linalg.norm(x - 5.0, axis=-1) < 3.0
    write_image(tmp_path / "t1.nii.gz", Image(ball * 100.0, affine))
    write_image(tmp_path / "seg.nii.gz", LabelVolume(ball * 3, affine))
    u = np.tile([1.0, 0.0, -0.5], (block.n_points, 1))
    write_prediction(tmp_path / "out.vtu", block, {"displacement_mm": u})
    said: list[str] = []
    names = ("w.nii.gz", "t.h5", "t.nii.gz", "j.nii.gz", "s.png")
    moved, transform, field, jacobian, slices = (tmp_path / name for name in names)
    warp(
        tmp_path / "t1.nii.gz",
        tmp_path / "out.vtu",
        moved,
        field=[transform, field],
        jacobian=jacobian,
        slices=slices,
        log=said.append,
    )
    # two values are a label map's, of which the nearest is taken, and it is said
    assert set(np.unique(read_image(moved).data)) == {0, 100}
    assert "looks like a label map" in said[2]
    expected = np.linalg.norm(x - 5.0 - u[0], axis=-1) < 3.0
    np.testing.assert_array_equal(read_image(moved).data > 50, expected)
    np.testing.assert_allclose(read_image(jacobian).data, 1.0, atol=1e-6)
    assert slices.read_bytes().startswith(b"\x89PNG")
    assert said[0].startswith("round trip") and "nothing folds" in said[1]
    source = sitk.ReadTransform(str(transform)).TransformPoint((-5.0, -5.0, 5.0))
    np.testing.assert_allclose(source, [-4.0, -5.0, 5.5], atol=1e-6)

    warp(tmp_path / "seg.nii.gz", tmp_path / "out.vtu", moved, labels=True)
    np.testing.assert_array_equal(read_segmentation(moved).data, expected * 3)
    with pytest.raises(InputError, match="png"):
        warp(tmp_path / "t1.nii.gz", tmp_path / "out.vtu", moved, slices="slices.jpg")


def test_register_writes_what_warp_reads(tmp_path: Path) -> None:
    body = block_mesh(4, side=80.0)
    case, measured, out = (tmp_path / n for n in ("case.vtu", "m.csv", "out.vtu"))
    write_mesh(case, body)
    source = body.points[body.point_set("loaded")]
    moved = source + np.array([0.0, 1.0, -2.0])
    np.savetxt(measured, np.hstack([source, moved]), delimiter=",")
    found = register(case, out, points=measured, noise_mm=0.5)
    mesh, u = read_displacement(out)
    np.testing.assert_array_equal(u, found.prediction.displacement)
    top = u[mesh.point_set("loaded")]
    np.testing.assert_allclose(top.mean(axis=0), [0.0, 1.0, -2.0], atol=0.6)
    assert (u[mesh.point_set("fixed")] == 0).all()


def test_warp_refuses_what_mixes_labels(
    labels: LabelVolume, block: TetMesh, tmp_path: Path
) -> None:
    write_image(tmp_path / "seg.nii", labels)
    write_prediction(tmp_path / "u.vtu", block, {"displacement_mm": 0 * block.points})
    with pytest.raises(InputError, match="interpolation nearest"):
        warp(
            tmp_path / "seg.nii",
            tmp_path / "u.vtu",
            tmp_path / "out.nii",
            labels=True,
            interpolation="linear",
        )


def test_labels_that_cannot_be_meshed_as_they_are(
    labels: LabelVolume, tmp_path: Path
) -> None:
    seg = tmp_path / "seg.nii"
    write_image(seg, labels)
    with pytest.raises(InputError, match=r"not used: 4, 6 .*--ignore-labels"):
        mesh_segmentation(seg, "brain=1")
    with pytest.raises(InputError, match="brats-2020 mark the tumour alone"):
        mesh_segmentation(seg, "brats", ignore_labels=True)
    small = LabelVolume(np.where(labels.data == 4, 1, 0), labels.affine)
    write_image(seg, small)
    with pytest.raises(InputError, match=r"labelled brain: a brain must have 50"):
        mesh_segmentation(seg)
    grey = np.random.default_rng(0).integers(0, 900, labels.data.shape)
    write_image(seg, LabelVolume(grey, labels.affine))
    with pytest.raises(InputError, match="this is an image, not a segmentation"):
        mesh_segmentation(seg)


def test_a_mask_that_is_an_image_with_its_background(
    labels: LabelVolume, tmp_path: Path
) -> None:
    tumour = LabelVolume(np.where(labels.data == 4, 3, 0), labels.affine)
    write_image(tmp_path / "seg.nii", tumour)
    big = np.diag([5.0, 5.0, 5.0, 1.0])
    write_image(tmp_path / "seg.nii", LabelVolume(tumour.data, big))
    scored = np.random.default_rng(0).normal(size=labels.data.shape)
    write_image(tmp_path / "z.nii", Image(scored, big))  # 4096 ml
    with pytest.raises(InputError, match=r"z\.nii: brain mask: a brain must have"):
        mesh_segmentation(tmp_path / "seg.nii", "brats", brain_mask=tmp_path / "z.nii")


def test_what_a_mask_holds_hides_no_label_that_is_left_out(tmp_path: Path) -> None:
    """Most of a tumour became brain: of brain and tumour together it was 1 %."""
    big = np.diag([8.0, 8.0, 8.0, 1.0])
    ball = np.linalg.norm(np.moveaxis(np.indices((32, 32, 32)), 0, -1) - 15, axis=-1)
    tumour = np.where(ball < 2, 1, np.where(ball < 3, 3, 0))
    write_image(tmp_path / "seg.nii", LabelVolume(tumour, big))
    write_image(tmp_path / "mask.nii", LabelVolume((ball < 9).astype(int), big))
    given = {"brain_mask": tmp_path / "mask.nii"}
    with pytest.raises(InputError, match=r"not used: 3 .* of the labelled volume"):
        mesh_segmentation(tmp_path / "seg.nii", "brats-2020", **given)


@needs_tetgen
def test_each_label_is_accounted_for(labels: LabelVolume, tmp_path: Path) -> None:
    write_image(tmp_path / "seg.nii", labels)
    said: list[str] = []
    mesh_segmentation(
        tmp_path / "seg.nii",
        "brain=1,tumour=4+7",
        target_points=1500,
        ignore_labels=True,
        log=said.append,
    )
    ml = (labels.data == 6).sum() * 0.027
    assert f"not used: 6 ({ml:.3g} ml)" in said
    assert "asked for, not there: tumour=7" in said
    (line,) = (line for line in said if line.startswith("label 4 → tumour: 5."))
    assert float(line.split()[-1]) > 0.9


@needs_tetgen
def test_a_surface_has_the_size_of_a_brain(tmp_path: Path) -> None:
    pv.Icosphere(radius=15.0, nsub=2).save(tmp_path / "ball.stl")
    case = tmp_path / "case.vtu"
    with pytest.raises(InputError, match=r"ball\.stl: a brain must have 50"):
        mesh(case, brain=tmp_path / "ball.stl", target_points=1000)
    mesh(case, brain=tmp_path / "ball.stl", target_points=1000, any_size=True)
    assert "another run gives other points" in pv.read(case).field_data["mesher"][0]


@needs_tetgen
def test_a_segmentation_of_slicer_meshes_by_its_names(
    labels: LabelVolume, tmp_path: Path
) -> None:
    names = {1: "Brain", 4: "Tumor core", 6: "ventricles"}
    path, said = tmp_path / "a.seg.nrrd", list[str]()
    write_image(path, LabelVolume(labels.data, labels.affine, names))
    made = mesh_segmentation(path, target_points=1500, log=said.append)
    for region, label in ((0, 1), (1, 4), (2, 6)):
        wanted = (labels.data == label).sum() * 27.0
        inside = made.region == region
        assert made.cell_volumes[inside].sum() == pytest.approx(wanted, rel=0.03)
    assert any("label 4 → tumour (Tumor core)" in line for line in said)


def test_names_that_mean_no_tissue_are_asked_for(
    labels: LabelVolume, tmp_path: Path
) -> None:
    names = {1: "Segment_1", 4: "Segment_2", 6: "Segment_3"}
    path = tmp_path / "a.seg.nrrd"
    write_image(path, LabelVolume(labels.data, labels.affine, names))
    with pytest.raises(InputError, match=r"called brain .*1 'Segment_1'.*--labels"):
        mesh_segmentation(path)
    with pytest.raises(InputError, match="nothing is called 'skull'"):
        mesh_segmentation(path, "brain=skull")


@pytest.mark.parametrize("suffix", [".nrrd", ".mha", ".mhd", ".mgz", ".nii"])
def test_what_is_warped_keeps_its_format(suffix: str, tmp_path: Path) -> None:
    body = block_mesh(2, side=40.0)
    write_prediction(
        tmp_path / "u.vtu", body, {"displacement_mm": np.zeros(body.points.shape)}
    )
    affine = np.diag([-2.0, 2.0, 2.5, 1.0])
    affine[:3, 3] = [45.0, -5.0, -5.0]
    image = Image(np.random.default_rng(0).normal(size=(25, 26, 21)), affine)
    write_image(tmp_path / f"t1{suffix}", image)
    source = tmp_path / f"t1{suffix}"
    warp(source, tmp_path / "u.vtu", tmp_path / "moved", jacobian=tmp_path / "detf")
    moved = read_image(tmp_path / f"moved{suffix}")
    np.testing.assert_allclose(moved.data, image.data, atol=1e-4)
    np.testing.assert_allclose(moved.affine, affine, atol=1e-5)
    assert read_image(tmp_path / f"detf{suffix}").data.shape == (25, 26, 21)
    warp(source, tmp_path / "u.vtu", tmp_path / "other.nii.gz")
    np.testing.assert_allclose(read_image(tmp_path / "other.nii.gz").data, moved.data)


def test_names_survive_warping(labels: LabelVolume, tmp_path: Path) -> None:
    names = {1: "brain", 4: "tumour", 6: "ventricle"}
    body = block_mesh(2, side=40.0)
    write_prediction(
        tmp_path / "u.vtu", body, {"displacement_mm": np.zeros(body.points.shape)}
    )
    path = tmp_path / "a.seg.nrrd"
    write_image(path, LabelVolume(labels.data, labels.affine, names))
    warp(path, tmp_path / "u.vtu", tmp_path / "moved.seg.nrrd", labels=True)
    moved = read_segmentation(tmp_path / "moved.seg.nrrd")
    assert moved.names == names
    np.testing.assert_array_equal(moved.data, labels.data)
    warp(path, tmp_path / "u.vtu", tmp_path / "unsaid", jacobian=tmp_path / "detf")
    assert read_segmentation(tmp_path / "unsaid.seg.nrrd").names == names
    np.testing.assert_allclose(read_image(tmp_path / "detf.nrrd").data, 1.0)
    write_image(tmp_path / "t1.nrrd", Image(1.5 * labels.data, labels.affine))
    before = sorted(tmp_path.iterdir())
    with pytest.raises(InputError, match=r"holds labels, no image: name a \.nrrd"):
        warp(tmp_path / "t1.nrrd", tmp_path / "u.vtu", tmp_path / "t1b.seg.nrrd")
    assert sorted(tmp_path.iterdir()) == before

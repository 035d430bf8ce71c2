"""Label maps of tumours alone get their ventricles from the T1."""

from pathlib import Path

import nibabel as nib
import numpy as np
import pytest

from heads import template
from physgnn.errors import InputError
from physgnn.geometry.image import LabelVolume
from physgnn.geometry.segmentation.label_report import label_volumes
from physgnn.geometry.segmentation.labels.label_tables import MASKED, label_table
from physgnn.io import read_mesh
from physgnn.stages import mesh
from physgnn.stages.patient.preoperative.t1_ventricles import with_t1_ventricles

TUMOUR_MM, RADIUS, OEDEMA = (20.0, -30.0, 30.0), 10.0, 16.0


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return a T1 at 2 mm and BraTS labels: a tumour that reaches into a ventricle."""
    folder = tmp_path_factory.mktemp("case")
    t1, _ = template()
    data = np.asarray(t1.data)[::2, ::2, ::2]
    affine = t1.affine @ np.diag([2.0, 2.0, 2.0, 1.0])
    x = np.moveaxis(np.indices(data.shape), 0, -1) @ affine[:3, :3].T + affine[:3, 3]
    away = np.linalg.norm(x - TUMOUR_MM, axis=-1)
    labels = np.where(away < RADIUS, 4, np.where(away < OEDEMA, 2, 0)).astype(np.int16)
    paths = folder / "t1.nii.gz", folder / "labels.nii.gz"
    for path, values in zip(paths, (data.astype(np.float32), labels), strict=True):
        nib.save(nib.Nifti1Image(values, affine), path)
    return paths


def with_mask(labels: Path, t1: Path) -> LabelVolume:
    image = nib.load(labels)
    data, inside = np.asarray(image.dataobj), np.asarray(nib.load(t1).dataobj) != 0
    return LabelVolume(
        np.where((data == 0) & inside, MASKED, data).astype(np.int32), image.affine
    )


def test_ventricles_come_beside_tumour_and_oedema(case: tuple[Path, Path]) -> None:
    t1, labels = case
    before, table = with_mask(labels, t1), label_table("brats-2020")
    after, named = with_t1_ventricles(before, table, t1)
    (new,) = named.labels["ventricle"]
    found = after.data == new
    assert set(np.unique(before.data[found])) == {MASKED}
    np.testing.assert_array_equal(after.data[~found], before.data[~found])
    assert 10.0 < label_volumes(after)[new] < 30.0
    # both bodies, where atlases have them
    for side in (-10.0, 10.0):
        i, j, k = np.rint(after.grid.to_index(np.array([[side, 5, 20]]))[0]).astype(int)
        assert found[i - 1 : i + 2, j - 1 : j + 2, k - 1 : k + 2].any()


def test_what_cannot_be_used_is_named(case: tuple[Path, Path], tmp_path: Path) -> None:
    t1, labels = case
    before = with_mask(labels, t1)
    own = label_table(f"brain=2,tumour=4,ventricle={MASKED}")
    with pytest.raises(InputError, match="ventricles of its own"):
        with_t1_ventricles(before, own, t1)
    image = nib.load(t1)
    other = tmp_path / "other.nii.gz"
    nib.save(image.slicer[2:], other)
    with pytest.raises(
        InputError, match=r"other\.nii\.gz: the T1 must have the voxels"
    ):
        with_t1_ventricles(before, label_table("brats-2020"), other)
    with pytest.raises(InputError, match="needs a label map"):
        mesh(tmp_path / "case.vtu", mni152=True, ventricles=t1)


@pytest.mark.slow
def test_mesh_has_them(case: tuple[Path, Path], tmp_path: Path) -> None:
    t1, labels = case
    out, lines = tmp_path / "case.vtu", []
    mesh(
        out,
        segmentation=labels,
        labels="brats-2020",
        brain_mask=t1,
        ventricles=t1,
        log=lines.append,
    )
    made = read_mesh(out)
    assert set(made.region) == {0, 1, 2}
    assert any("ventricle, from the T1" in line for line in lines)


@pytest.mark.slow
def test_glioma_keeps_its_tumour(shared: Path) -> None:
    t1, labels = (
        shared / "real" / f"glioma_{name}.nii.gz"
        for name in ("t1_brain", "segmentation")
    )
    if not (t1.exists() and labels.exists()):
        pytest.skip("the glioma of shared/real is not here")
    before, table = with_mask(labels, t1), label_table("brats-2020")
    after, named = with_t1_ventricles(before, table, t1)
    volumes = label_volumes(after)
    assert 20.0 < volumes[named.labels["ventricle"][0]] < 40.0
    for label in (1, 2, 4):
        assert volumes.get(label) == label_volumes(before).get(label)

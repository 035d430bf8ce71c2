from pathlib import Path

import nibabel as nib
import numpy as np
import pytest
import pyvista as pv
import SimpleITK as sitk

from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.displacement_files import FORMS, DisplacementFields, form_of
from physgnn.io.medical.images.formats import read_segmentation
from physgnn.io.vtk.prediction_file import read_displacement

SHIFT = np.array([1.0, -2.0, 0.5])
NAMES = {
    "rest": "a.vtu",
    "deformed": "b.vtu",
    "transform": "c.h5",
    "field": "d.nii.gz",
    "itk-field": "e.nii.gz",
    "labels": "f.nii",
}


@pytest.fixture
def fields(block: TetMesh) -> DisplacementFields:
    affine = np.diag([-0.5, -0.5, 0.5, 1.0])
    affine[:3, 3] = 14.75, 14.75, -4.75
    fields = {"displacement_mm": np.tile(SHIFT, (block.n_points, 1))}
    return DisplacementFields(block, fields, ImageGrid((40, 40, 40), affine))


def test_a_shift_is_the_same_in_every_form(
    fields: DisplacementFields, block: TetMesh, tmp_path: Path
) -> None:
    for name, form in FORMS.items():
        form_of(tmp_path / NAMES[name], name).write(tmp_path / NAMES[name], fields)
        assert form_of(NAMES[name], name) is form
    _, u = read_displacement(tmp_path / "a.vtu")
    np.testing.assert_array_equal(u, fields.displacement)
    moved = pv.read(tmp_path / "b.vtu")
    np.testing.assert_allclose(moved.points, block.points + SHIFT, atol=1e-6)
    middle = np.array([5.0, 5.0, 5.0])
    transform = sitk.ReadTransform(str(tmp_path / "c.h5"))
    lps = np.array([-1.0, -1.0, 1.0])
    back = np.array(transform.TransformPoint((middle * lps).tolist())) * lps
    np.testing.assert_allclose(back, middle - SHIFT, atol=1e-6)
    forward, inverse = (nib.load(tmp_path / name) for name in ("d.nii.gz", "e.nii.gz"))
    at = tuple(fields.voxels.to_index(middle[None])[0].round().astype(int))
    np.testing.assert_allclose(forward.get_fdata()[at], SHIFT, atol=1e-6)
    np.testing.assert_allclose(inverse.get_fdata()[at][0], -SHIFT * lps, atol=1e-6)


def test_labels_are_where_the_regions_go(
    fields: DisplacementFields, tmp_path: Path
) -> None:
    path = tmp_path / NAMES["labels"]
    form_of(path, "labels").write(path, fields)
    found = read_segmentation(path)
    volume = (found.data > 0).sum() * found.grid.voxel_volume_mm3
    assert volume == pytest.approx(1000.0)
    assert set(np.unique(found.data)) == {0, 1, 2}
    heights = [
        found.grid.to_world(np.argwhere(found.data == label))[:, 2].mean()
        for label in (1, 2)
    ]
    assert heights[0] < 5.5 < heights[1]
    centre = found.grid.to_world(np.argwhere(found.data > 0)).mean(axis=0)
    np.testing.assert_allclose(centre, 5.0 + SHIFT, atol=0.01)


def test_the_name_decides(tmp_path: Path) -> None:
    assert form_of("a.vtu") is FORMS["rest"]
    assert form_of("a.vtp") is FORMS["deformed"]
    assert form_of("a.nii") is FORMS["field"]
    with pytest.raises(InputError, match=r"a\.stl.*\.vtu, \.vtp, \.h5, \.nii\.gz"):
        form_of("a.stl")
    assert form_of("A.NII.GZ") is FORMS["field"]
    with pytest.raises(InputError, match="--as labels"):
        form_of("a.nrrd")  # labels are no displacement: only where they are named
    assert form_of("a.nrrd", "labels") is FORMS["labels"]
    with pytest.raises(InputError, match="--image is for a field"):
        FORMS["rest"].check_image("a.vtu", "t1.nii.gz")
    FORMS["field"].check_image("a.nii", "t1.nii.gz")
    with pytest.raises(InputError, match=r"'labels' is written as \.nii\.gz"):
        form_of(tmp_path / "a.vtu", "labels")
    with pytest.raises(InputError, match="form must be one of"):
        form_of("a.vtu", "picture")


def test_without_an_image_the_grid_holds_body_and_fade(block: TetMesh) -> None:
    u = np.tile([20.0, 0.0, 0.0], (block.n_points, 1))
    grid = DisplacementFields(block, {"displacement_mm": u}).voxels
    low, high = grid.to_world([[0, 0, 0], np.array(grid.shape) - 1])
    assert (low <= -80).all() and (high >= 90).all()

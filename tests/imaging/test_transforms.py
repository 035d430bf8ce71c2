"""Known motions after a trip through files, read by other programs' own readers."""

from pathlib import Path

import nibabel as nib
import numpy as np
import pytest
import SimpleITK as sitk

from imaging.conftest import centre_of, rigid, spot
from physgnn.errors import InputError
from physgnn.geometry.image import Image, ImageGrid
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging import forward_field, inverse_field
from physgnn.imaging.transforms import from_itk, resampling_transform, to_itk
from physgnn.io.medical.images.formats import read_image, write_image
from physgnn.io.medical.transforms import write_field

MOTIONS = {
    "translation": ((0, 0, 0), (1.5, -1.0, 0.5)),
    "rotation": ((0, 0, 15), (0, 0, 0)),
    "both": ((10, -5, 8), (0.5, 0.5, -1.0)),
}
SPOT = np.array([6.5, 4.0, 5.5])


def itk_transform(path: Path) -> sitk.Transform:
    """Read a file as SimpleITK, 3D Slicer and ANTs do."""
    if path.suffix == ".h5":
        return sitk.ReadTransform(str(path))
    vectors = sitk.ReadImage(str(path), sitk.sitkVectorFloat64)
    assert vectors.GetNumberOfComponentsPerPixel() == 3
    return sitk.DisplacementFieldTransform(vectors)


@pytest.mark.parametrize("name", ["transform.h5", "field.nii.gz"])
@pytest.mark.parametrize("motion", MOTIONS)
def test_a_known_motion_lands_where_it_must(
    motion: str, name: str, block: TetMesh, oblique: ImageGrid, tmp_path: Path
) -> None:
    u = rigid(block, *MOTIONS[motion])
    inside = np.array([SPOT])
    weights = np.column_stack([block.points, np.ones(block.n_points)])
    affine = np.linalg.lstsq(weights, block.points + u)[0]
    expected = np.append(inside[0], 1.0) @ affine
    write_image(tmp_path / "rest.nii.gz", spot(oblique, SPOT))
    write_field(tmp_path / name, inverse_field(block, u, oblique))

    transform = itk_transform(tmp_path / name)
    # ITK maps where the spot is after the motion, in LPS, to where it was
    lps = np.array([-1.0, -1.0, 1.0])
    source = np.array(transform.TransformPoint((lps * expected).tolist()))
    np.testing.assert_allclose(lps * source, SPOT, atol=0.02)
    image = sitk.ReadImage(str(tmp_path / "rest.nii.gz"))
    moved = sitk.Resample(image, image, transform, sitk.sitkLinear)
    sitk.WriteImage(moved, str(tmp_path / "moved.nii.gz"))

    back = nib.load(tmp_path / "moved.nii.gz")
    found = Image(
        np.asarray(back.dataobj) * (np.asarray(back.dataobj) > 0.2), back.affine
    )
    np.testing.assert_allclose(centre_of(found), expected, atol=0.1)


def test_images_keep_their_place(oblique: ImageGrid, tmp_path: Path) -> None:
    image = spot(oblique, SPOT)
    back = from_itk(to_itk(image))
    np.testing.assert_array_equal(back.data, image.data)
    np.testing.assert_allclose(back.affine, image.affine, atol=1e-12)
    ours = to_itk(image).TransformContinuousIndexToPhysicalPoint((3.0, 4.0, 5.0))
    x, y, z = oblique.to_world([[3.0, 4.0, 5.0]])[0]
    np.testing.assert_allclose(ours, [-x, -y, z])
    # SimpleITK's reader and nibabel's agree about a file on the way between them
    write_image(tmp_path / "image.nii.gz", image)
    theirs = from_itk(sitk.ReadImage(str(tmp_path / "image.nii.gz")))
    np.testing.assert_allclose(theirs.affine, image.affine, atol=1e-4)
    np.testing.assert_allclose(
        theirs.data, read_image(tmp_path / "image.nii.gz").data, atol=1e-7
    )


def test_ras_file_says_where_rest_points_go(
    block: TetMesh, oblique: ImageGrid, tmp_path: Path
) -> None:
    u = np.tile([1.0, 2.0, -3.0], (block.n_points, 1))
    path = tmp_path / "u.nii.gz"
    write_field(path, forward_field(block, u, oblique), convention="ras")
    image = nib.load(path)
    assert image.shape == (*oblique.shape, 3)
    centre = tuple(n // 2 for n in oblique.shape)
    np.testing.assert_allclose(np.asarray(image.dataobj)[centre], [1.0, 2.0, -3.0])
    np.testing.assert_allclose(image.affine, oblique.affine, atol=1e-6)
    assert b"forward" in bytes(image.header["descrip"])


def test_the_wrong_direction_or_name_is_refused(
    block: TetMesh, oblique: ImageGrid, tmp_path: Path
) -> None:
    u = np.zeros_like(block.points)
    forward, inverse = (
        make(block, u, oblique) for make in (forward_field, inverse_field)
    )
    with pytest.raises(InputError, match="inverse"):
        resampling_transform(forward)
    for name in ("a.h5", "a.nii.gz"):
        with pytest.raises(InputError, match="inverse"):
            write_field(tmp_path / name, forward)
    with pytest.raises(InputError, match="written as"):
        write_field(tmp_path / "a.nii.gz", inverse, convention="itk-transform")
    with pytest.raises(InputError, match="convention"):
        write_field(tmp_path / "a.nii.gz", inverse, convention="fsl")
    with pytest.raises(InputError, match="written as"):
        write_field(tmp_path / "a.mha", inverse)
    assert list(tmp_path.iterdir()) == []

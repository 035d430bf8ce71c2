"""Surfaces of synthetic label maps, whose truth is known, and of the MNI152 maps."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry import check_nested, check_surface, volume
from physgnn.geometry.image import ImageGrid, LabelVolume
from physgnn.geometry.segmentation.extract import (
    Segmentation,
    edge_for,
    extract_surfaces,
)
from physgnn.geometry.segmentation.labels.label_tables import (
    LABEL_TABLES,
    LabelTable,
    label_table,
)
from physgnn.geometry.segmentation.mask_surface import level_set
from physgnn.geometry.segmentation.masks import tissue_masks
from physgnn.io.medical.images.formats import read_segmentation, write_image

TABLE = label_table("brain=1,tumour=4,ventricle=6")
CENTRE = np.array([12.0, -7.0, 31.0])
AXES = np.array([45.0, 55.0, 40.0])
TUMOUR, VENTRICLE = np.array([18.0, 6.0, 10.0]), np.array([-14.0, 0.0, 0.0])
BEHIND = np.array([0.0, -35.0, 0.0])

ORIENTATIONS = {
    "ras": (np.eye(3), (2.0, 2.0, 2.0)),
    "lps": (np.diag([-1.0, -1.0, 1.0]), (2.0, 2.0, 2.0)),
    "oblique, thick slices": (
        Rotation.from_euler("zyx", [25, -15, 10], degrees=True).as_matrix(),
        (1.5, 1.5, 4.0),
    ),
    "left-handed, axes swapped": (
        np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 1]]),
        (3.0, 1.5, 2.0),
    ),
}


def phantom(directions: FloatArray, voxel: tuple[float, ...]) -> LabelVolume:
    """An ellipsoidal brain with a tumour and a ventricle, in any image."""
    shape = tuple(int(140 / size) for size in voxel)
    affine = np.eye(4)
    affine[:3, :3] = directions @ np.diag(voxel)
    affine[:3, 3] = CENTRE - affine[:3, :3] @ (np.array(shape) - 1) / 2
    grid = ImageGrid(shape, affine)  # type: ignore[arg-type]
    index = np.stack(np.indices(shape), -1).reshape(-1, 3)
    x = (grid.to_world(index) - CENTRE).reshape(*shape, 3)
    data = (((x / AXES) ** 2).sum(-1) <= 1).astype(np.int32)
    data[np.linalg.norm(x - TUMOUR, axis=-1) <= 11] = 4
    data[(((x - VENTRICLE) / [6, 20, 9]) ** 2).sum(-1) <= 1] = 6
    return LabelVolume(data, affine)


def check_whole(found: Segmentation) -> None:
    for surface in (found.brain, *found.tumours, *found.ventricles):
        assert check_surface(surface, "surface")[1] == []
        assert volume(surface) > 0
    check_nested(found.brain, [*found.tumours, *found.ventricles])


@pytest.mark.parametrize("name", ORIENTATIONS)
def test_surfaces_lie_where_the_truth_is_in_any_image(name: str) -> None:
    labels = phantom(*ORIENTATIONS[name])
    found = extract_surfaces(labels, TABLE, target_points=4000)
    check_whole(found)
    assert found.notes == ()
    assert list(found.fits) == ["brain", "tumour 1", "ventricle 1"]
    voxel = max(ORIENTATIONS[name][1])
    for fit in found.fits.values():
        assert abs(fit.volume_error) < 0.01
        assert fit.distance_mm < 0.5 * voxel
    true = 4 / 3 * np.pi * AXES.prod()
    assert volume(found.brain) == pytest.approx(true, rel=0.02)
    distance = np.linalg.norm((found.brain.points - CENTRE) / AXES, axis=1)
    assert np.abs(distance - 1).mean() * AXES.mean() < 0.3 * voxel
    middle = found.tumours[0].points.mean(axis=0)
    np.testing.assert_allclose(middle, CENTRE + TUMOUR, atol=0.3)


def test_more_points_asked_for_make_finer_surfaces() -> None:
    labels = phantom(*ORIENTATIONS["ras"])
    few = extract_surfaces(labels, TABLE, target_points=2000)
    many = extract_surfaces(labels, TABLE, target_points=16_000)
    # eight times the points in space, four times on a surface
    assert many.brain.n_points / few.brain.n_points == pytest.approx(4.0, rel=0.1)
    assert edge_for(1.5e6, 9118) == pytest.approx(6.0, rel=0.03)  # the published mesh


def test_holes_and_islands_are_mended_and_said() -> None:
    labels = phantom(*ORIENTATIONS["ras"])
    data = labels.data.copy()
    inside = np.argwhere(data == 1)
    hole = inside[len(inside) // 2]
    data[tuple(slice(i - 2, i + 2) for i in hole)] = 0
    data[2:5, 2:5, 2:5] = 1
    data[tuple((labels.grid.to_index(CENTRE + BEHIND)).round().astype(int))] = 4
    found = extract_surfaces(LabelVolume(data, labels.affine), TABLE)
    assert len(found.notes) == 3
    assert "brain: 1 island dropped, 0.22 ml" in found.notes[0]
    assert "brain: holes filled, 0.51 ml" in found.notes[1]
    assert "tumour: 1 piece" in found.notes[2] and len(found.tumours) == 1
    check_whole(found)


def test_a_piece_of_tumour_far_from_the_brain_is_dropped_with_its_island() -> None:
    labels = phantom(*ORIENTATIONS["ras"])
    data = labels.data.copy()
    data[1:6, 1:6, 1:6] = 4  # 1 ml
    found = extract_surfaces(LabelVolume(data, labels.affine), TABLE)
    assert found.notes == (
        "brain: 1 island dropped, 1.00 ml",
        "tumour: apart from the brain, so dropped with it, 1.00 ml",
    )
    assert len(found.tumours) == 1
    check_whole(found)


def test_a_tumour_at_the_surface_is_kept_inside_and_it_is_said() -> None:
    labels = phantom(*ORIENTATIONS["ras"])
    data = labels.data.copy()
    index = np.stack(np.indices(data.shape), -1).reshape(-1, 3)
    x = (labels.grid.to_world(index) - CENTRE).reshape(*data.shape, 3)
    data[(np.linalg.norm(x - [0, 50, 0], axis=-1) < 9) & (data == 1)] = 4
    found = extract_surfaces(LabelVolume(data, labels.affine), TABLE)
    check_whole(found)
    assert len(found.tumours) == 2
    assert "tumour 2" in found.notes[-1] and "given to the brain" in found.notes[-1]


def test_smoothing_keeps_the_volume_of_the_mask() -> None:
    masks = tissue_masks(phantom(*ORIENTATIONS["oblique, thick slices"]), TABLE)
    for smoothing in (0.0, 4.0):
        distance = level_set(masks.brain, masks.grid, smoothing)
        assert (distance < 0).sum() == pytest.approx(masks.brain.sum(), rel=1e-3)


def test_a_brain_that_touches_the_image_border_is_closed() -> None:
    labels = phantom(*ORIENTATIONS["ras"])
    half = LabelVolume(labels.data[: labels.data.shape[0] // 2], labels.affine)
    found = extract_surfaces(half, label_table("brain=1"), target_points=2000)
    check_whole(found)
    assert abs(found.fits["brain"].volume_error) < 0.01
    # half an ellipsoid: the section has the area of an ellipse
    area = np.pi * AXES[1] * AXES[2] / 100.0
    said = [note for note in found.notes if "at the image's border" in note]
    assert len(said) == 1 and "last slice of axis 0" in said[0]
    assert float(said[0].split()[1]) == pytest.approx(area, rel=0.05)
    whole = labels.data
    used = [
        np.flatnonzero((whole == 1).any(axis=(*{0, 1, 2} - {i},))) for i in range(3)
    ]
    tight = whole[tuple(slice(u[0], u[-1] + 1) for u in used)]
    notes = tissue_masks(LabelVolume(tight, labels.affine), TABLE).notes
    assert not any("border" in note for note in notes)


def test_a_tissue_of_specks_is_not_taken_for_brain() -> None:
    labels = phantom(*ORIENTATIONS["ras"])
    odd = np.indices(labels.data.shape).sum(axis=0) % 2 == 1
    checks = np.where(odd & (labels.data == 1), 4, labels.data)
    with pytest.raises(InputError, match=r"tumour must have pieces.*--smallest-mm3"):
        tissue_masks(LabelVolume(checks, labels.affine), TABLE)


def test_what_cannot_be_used_is_refused() -> None:
    labels = phantom(*ORIENTATIONS["ras"])
    with pytest.raises(InputError, match="no voxel has a label of brain"):
        extract_surfaces(labels, label_table("brain=9"))
    with pytest.raises(InputError, match="target_points"):
        extract_surfaces(labels, TABLE, target_points=10)
    with pytest.raises(InputError, match="smoothing_mm"):
        extract_surfaces(labels, TABLE, smoothing_mm=-1)
    cut = labels.data.copy()
    cut[cut.shape[0] // 2 - 2 : cut.shape[0] // 2 + 2] = 0
    with pytest.raises(InputError, match="one piece"):
        extract_surfaces(LabelVolume(cut, labels.affine), label_table("brain=1"))


def test_mni152_tissue_maps_make_a_brain(tmp_path: Path) -> None:
    from nilearn.datasets import load_mni152_gm_mask, load_mni152_wm_mask

    grey, white = load_mni152_gm_mask(resolution=2), load_mni152_wm_mask(resolution=2)
    data = np.asarray(grey.dataobj) * 1 + (np.asarray(white.dataobj) > 0) * 2
    data = np.minimum(data, 2).astype(np.int32)
    path = tmp_path / "tissues.nii.gz"
    write_image(path, LabelVolume(data, grey.affine))
    table = LabelTable({"brain": (1, 2)}, closing_mm=6.0)
    found = extract_surfaces(read_segmentation(path), table)
    check_whole(found)
    assert "folds narrower than 12 mm (closing_mm 6): " in found.notes[0]
    assert abs(found.fits["brain"].volume_error) < 0.02
    assert found.fits["brain"].distance_mm < 2.0
    assert LABEL_TABLES["freesurfer"].closing_mm > 0

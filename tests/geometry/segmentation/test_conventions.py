"""Label maps of every convention mesh: their tissues survive, by name, and apart."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry import check_nested, check_surface
from physgnn.geometry.image import LabelVolume
from physgnn.geometry.segmentation.extract import Segmentation, extract_surfaces
from physgnn.geometry.segmentation.label_report import check_all_used, label_volumes
from physgnn.geometry.segmentation.labels.label_tables import (
    LABEL_TABLES,
    label_table,
    resolved,
)
from physgnn.geometry.segmentation.mask_surface import level_set, stepped_surface
from physgnn.geometry.segmentation.masks import tissue_masks
from physgnn.io.medical.images.formats import read_segmentation

SIZE, VOXEL = 56, 3.0


def head(
    brain: tuple[int, int, int], inner: Sequence[tuple[FloatArray, FloatArray, int]]
) -> LabelVolume:
    """A brain of two halves and a cerebellum (0 for none) with ellipsoids in it."""
    left, right, cerebellum = brain
    x = np.moveaxis(np.indices((SIZE,) * 3), 0, -1) * VOXEL
    x = x - VOXEL * (SIZE - 1) / 2
    whole = ((x / [62.0, 75.0, 55.0]) ** 2).sum(-1) <= 1
    data = np.where(x[..., 0] < 0, left, right)
    behind = (x[..., 1] < -15) & (x[..., 2] < -25)
    data[behind] = cerebellum or data[behind]
    data[~whole] = 0
    for centre, axes, label in inner:
        data[(((x - centre) / axes) ** 2).sum(-1) <= 1] = label
    affine = np.diag([VOXEL, VOXEL, VOXEL, 1.0])
    affine[:3, 3] = -VOXEL * (SIZE - 1) / 2
    return LabelVolume(data.astype(np.int32), affine)


def at(*place: float) -> FloatArray:
    return np.array(place)


LEFT_HORN = (at(-14, 0, 10), at(6, 25, 9))
RIGHT_HORN = (at(14, 0, 10), at(6, 25, 9))
TUMOUR = (at(30, 25, 10), at(14, 14, 14))
CORE = (at(30, 25, 10), at(7, 7, 7))
SWELLING = (at(30, 25, 10), at(20, 20, 20))

CASES = {
    "freesurfer": head((2, 41, 8), [(*LEFT_HORN, 4), (*RIGHT_HORN, 43)]),
    "freesurfer, parcels": head((1022, 2022, 47), [(*LEFT_HORN, 4), (*RIGHT_HORN, 43)]),
    "freesurfer, a2009s": head(
        (11129, 12129, 47), [(*LEFT_HORN, 4), (*RIGHT_HORN, 43)]
    ),
    "synthseg": head((3, 42, 8), [(*LEFT_HORN, 4), (*RIGHT_HORN, 43)]),
    "neuromorphometrics": head((45, 44, 38), [(*LEFT_HORN, 52), (*RIGHT_HORN, 51)]),
    "harvard-oxford": head((1, 12, 0), [(*LEFT_HORN, 3), (*RIGHT_HORN, 14)]),
    "atlas": head((7, 8, 93), []),
    "brats-2013": head((5, 5, 5), [(*SWELLING, 2), (*TUMOUR, 4), (*CORE, 3)]),
    "brats-2020": head((5, 5, 5), [(*SWELLING, 2), (*TUMOUR, 4), (*CORE, 1)]),
    "brats-2023": head((5, 5, 5), [(*SWELLING, 2), (*TUMOUR, 3), (*CORE, 1)]),
    "brats-post": head((5, 5, 5), [(*TUMOUR, 3), (*LEFT_HORN, 4)]),
    "brats-ped": head((5, 5, 5), [(*SWELLING, 4), (*TUMOUR, 2), (*CORE, 1)]),
    "brats-men-rt": head((5, 5, 5), [(*TUMOUR, 1)]),
    "msd": head((5, 5, 5), [(*SWELLING, 1), (*TUMOUR, 3), (*CORE, 2)]),
}
NAMED = {"left lateral ventricle", "right lateral ventricle"}


def check_whole(found: Segmentation) -> None:
    surfaces = [found.brain, *found.tumours, *found.ventricles]
    for name, surface in zip(found.fits, surfaces, strict=True):
        assert check_surface(surface, name)[1] == []
    check_nested(found.brain, surfaces[1:])
    assert found.fits["brain"].dice >= 0.95
    for name, fit in found.fits.items():
        assert fit.worst_dice >= (0.95 if "tumour" in name else 0.9), (name, str(fit))


@pytest.mark.parametrize("case", CASES)
def test_every_tissue_survives(case: str) -> None:
    labels = CASES[case]
    name, _ = resolved(case.split(",")[0], label_volumes(labels))
    table = label_table(name)
    assert check_all_used(label_volumes(labels), table) == []
    found = extract_surfaces(labels, table)
    check_whole(found)
    names = set(found.fits) - {"brain"}
    anatomical = any("lateral" in text for text in table.names.values())
    assert names == (NAMED if anatomical else names)
    assert ("tumour 1" in names) == ("tumour" in table.labels)


def test_every_convention_is_tried() -> None:
    tried = {case.split(",")[0] for case in CASES} | {"mask", "segment", "brats"}
    assert tried == set(LABEL_TABLES)


def test_a_thin_bridge_is_cut_and_both_sides_survive() -> None:
    """As the aqueduct joins the third and the fourth ventricle."""
    bridge = (at(0, 0, 10), at(20, 2, 2))
    inner = [(*bridge, 14), (*LEFT_HORN, 4), (*RIGHT_HORN, 43)]
    labels = head((2, 41, 8), inner)
    found = extract_surfaces(labels, LABEL_TABLES["freesurfer"])
    check_whole(found)
    assert len(found.ventricles) == 2 and len(found.fits) == 3
    assert "ventricle: 1 pieces cut where they are thin, into 2" in found.notes


def test_a_name_holds_every_structure_of_a_piece() -> None:
    inner = [(at(0, 0, 0), at(16, 16, 16), 4), (at(9, 0, 0), at(7, 9, 9), 14)]
    masks = tissue_masks(head((2, 41, 8), inner), LABEL_TABLES["freesurfer"])
    assert masks.names == ("left lateral and third ventricle",)


def test_small_lesions_are_kept_on_request() -> None:
    small = (at(-30, -10, 10), at(4, 4, 4))
    labels = head((5, 5, 5), [(*TUMOUR, 3), (*small, 3)])
    table = LABEL_TABLES["brats-2023"]
    assert len(extract_surfaces(labels, table, smallest_mm3=400).tumours) == 1
    found = extract_surfaces(labels, table, smallest_mm3=0)
    assert list(found.fits) == ["brain", "tumour 1", "tumour 2"]
    assert found.fits["tumour 2"].label_volume_mm3 < 400
    with pytest.raises(InputError, match="smallest_mm3"):
        extract_surfaces(labels, table, smallest_mm3=-1)


def test_a_convention_and_what_differs_from_it() -> None:
    table = label_table("freesurfer,tumour=99+25")
    assert table.tissue(99) == table.tissue(25) == "tumour"
    assert table.tissue(2) == "brain" and table.closing_mm > 0
    assert resolved("atlas", [3, 1])[0] == "atlas,brain=1+3"
    with pytest.raises(InputError):
        label_table("freesurfer,skull=1")


def test_marching_cubes_never_cross_whatever_the_mask() -> None:
    rng = np.random.default_rng(0)
    labels = CASES["brats-men-rt"]
    noise = rng.random(labels.data.shape) < 0.3
    mask = labels.mask((1,)) & ~noise
    surface = stepped_surface(level_set(mask, labels.grid, 3.0), labels.grid)
    assert check_surface(surface, "piece")[1] == []


def test_a_real_freesurfer_map(shared: Path) -> None:
    labels = read_segmentation(shared / "real" / "freesurfer_labels_02.nii.gz")
    found = extract_surfaces(labels, LABEL_TABLES["freesurfer"])
    check_whole(found)
    assert "fourth ventricle" in found.fits
    big = found.fits["left lateral, right lateral and third ventricle"]
    assert min(big.structures.values()) > 0.9


def test_what_fills_the_folds_is_said() -> None:
    """A fold whose fluid the map labels, as FreeSurfer's label 24 does."""
    fold = head((2, 41, 8), [(at(0, 0, 40), at(4, 30, 30), 24)])
    notes = tissue_masks(fold, LABEL_TABLES["freesurfer"]).notes
    assert "folds narrower than 8 mm (closing_mm 4): " in notes[0]
    assert "brain: of what was filled the map labels 100% as outside of it" in notes
    assert tissue_masks(fold, LABEL_TABLES["freesurfer"], closing_mm=0.0).notes == ()

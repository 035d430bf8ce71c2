"""The brain's surface in a scan that was made during the operation."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry import TetMesh
from physgnn.geometry.boundary import boundary_points
from physgnn.geometry.image import Image, ImageGrid, LabelVolume
from physgnn.geometry.surface import Surface
from physgnn.io.integrity.atomic import whole_file
from physgnn.io.medical.images.formats import read_image, read_segmentation
from physgnn.io.medical.linear_transforms import transformed
from physgnn.io.untrusted.input_errors import reading
from physgnn.progress import Log, no_log

# The scan must show so much of the preoperative brain's surface.
COVERED = 0.95
# Edge of the surface's triangles as of a mesh of so many points: finer than is used.
SURFACE_POINTS = 20_000


@dataclass(frozen=True)
class ScanOptions:
    """How an intraoperative scan is segmented: see `physgnn.segment`.

    Attributes
    ----------
    backend, contrast : str
        What finds the brain; the contrast of the scan.
    any_size : bool
        Whether what is found may be no brain by its size, shape and tissue.
    affine : str or None
        Which place of the scan is meant where its header has two.
    """

    backend: str = "auto"
    contrast: str = "t1"
    any_size: bool = False
    affine: str | None = None


def brain_surface(
    path: Path,
    matrix: FloatArray,
    *,
    mesh: TetMesh,
    how: ScanOptions,
    picture: Path | None = None,
    log: Log = no_log,
) -> Surface:
    """Return the surface of the brain in a scan or in a label map, in its own space.

    Parameters
    ----------
    path : Path
        An image; a label map is taken as such, with a word.
    matrix : (4, 4) array
        From its space to that of the preoperative scan.
    mesh : TetMesh
        The brain before, which the scan must show whole.
    how : ScanOptions
        How it is segmented.
    picture : Path, optional
        Where the outline goes, PNG.
    log : callable
        Called with what was found.

    Raises
    ------
    InputError
        If the image cannot be read or segmented, or does not show the whole brain.
    """
    from physgnn.geometry.segmentation.extract import edge_for
    from physgnn.geometry.segmentation.mask_surface import even_surface, level_set
    from physgnn.segmentation.picture import outlines
    from physgnn.segmentation.scan_labels import volumes_line

    image = read_image(path, affine=how.affine, log=log)
    _check_covers(path, image.grid, matrix, mesh)
    labels, brain, grid = _brain_in(path, image, how, log)
    if picture is not None:
        line = f"{path.name}: {volumes_line(labels)}"
        with whole_file(picture) as part:
            outlines(image, labels, line).savefig(part, dpi=110)
        log(f"{line}; look at {picture}")
    edge = edge_for(float(brain.sum()) * grid.voxel_volume_mm3, SURFACE_POINTS)
    distance = level_set(brain, grid, float(grid.voxel_mm.max()))
    return even_surface(distance, grid, edge)


def _brain_in(
    path: Path, image: Image, how: ScanOptions, log: Log
) -> tuple[LabelVolume, BoolArray, ImageGrid]:
    """Return labels to draw, and the brain, filled, on a grid around it."""
    from physgnn.geometry.segmentation.label_report import label_volumes
    from physgnn.geometry.segmentation.labels.label_tables import label_table, resolved
    from physgnn.geometry.segmentation.masks import tissue_masks
    from physgnn.segmentation import scan_labels
    from physgnn.segmentation.scan_checks import is_label_map

    if is_label_map(np.asarray(image.data)):
        if (how.backend, how.contrast) != (ScanOptions.backend, ScanOptions.contrast):
            raise InputError(
                f"{path}: this is a label map, which no program segments: leave "
                "--backend and --contrast out, or give the scan"
            )
        given = read_segmentation(path, log=log)
        with reading(path, "a label map of the brain"):
            present = label_volumes(given)
            name, lines = resolved("mask", present)
            for line in (f"{path}: taken for a label map, not a scan", *lines):
                log(line)
            masks = tissue_masks(given, label_table(_all_brain(name, present)))
        drawn = (given.data != 0).astype(np.int32)
        return LabelVolume(drawn, given.affine), masks.brain, masks.grid
    options = scan_labels.SegmentOptions(
        how.backend, how.contrast, ventricles=False, any_size=how.any_size
    )
    with reading(path, "an MR scan of a head"):
        found = scan_labels.segment(image, options, log=log)
        masks = tissue_masks(found, label_table("segment"))
    return found, masks.brain, masks.grid


def _all_brain(name: str, present: dict[int, float]) -> str:
    """Return a map's convention; without one all of its labels are brain."""
    if name != "mask" or set(present) <= {1}:
        return name
    return "brain=" + "+".join(map(str, sorted(present)))


def _check_covers(
    path: Path, grid: ImageGrid, matrix: FloatArray, mesh: TetMesh
) -> None:
    """Raise InputError if the image does not show the whole brain of the mesh."""
    surface = mesh.points[boundary_points(mesh)]
    back: FloatArray = np.linalg.inv(matrix).astype(np.float64)
    there = transformed(back, surface)
    index = grid.to_index(there)
    inside = ((index >= -0.5) & (index <= np.array(grid.shape) - 0.5)).all(axis=1)
    if inside.mean() < COVERED:
        raise InputError(
            f"{path}: an intraoperative scan must show the whole brain (it covers "
            f"{inside.mean():.0%} of its surface): give the whole scan, the transform "
            "to the preoperative one (--initial-transform), or what it shows as "
            "--surface"
        )

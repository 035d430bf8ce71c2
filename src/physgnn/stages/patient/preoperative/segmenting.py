"""From a scan to a label map."""

import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid, LabelVolume
from physgnn.io.integrity.atomic import whole_file
from physgnn.io.medical.images.formats import (
    named_like,
    read_image,
    read_segmentation,
    write_image,
)
from physgnn.io.medical.markups import POINT_READERS, read_points
from physgnn.io.untrusted.input_errors import reading
from physgnn.progress import Log, no_log
from physgnn.stages.outputs import Output, beside, writes

if TYPE_CHECKING:
    from physgnn.geometry.image import Image

LABELS = re.compile(r"\d+(\+\d+)*")
POINTS = tuple(POINT_READERS)


@writes(out=Output(like="scan"), picture=Output((".png",), beside="out"))
def segment(
    scan: str | Path,
    out: str | Path,
    *,
    backend: str = "auto",
    contrast: str = "t1",
    ventricles: bool = True,
    tumour: str | Path | None = None,
    tumour_labels: str | None = None,
    picture: str | Path | None = None,
    any_size: bool = False,
    affine: str | None = None,
    log: Log = no_log,
) -> LabelVolume:
    """Segment brain, ventricles and tumour of an MR scan, and draw what was found.

    Parameters
    ----------
    scan : path
        Image of a head, or of a brain whose skull has been taken off.
    out : path
        Where the label map goes: 1 brain, 2 tumour, 3 ventricle. Without a suffix it is
        written in the scan's own format.
    backend : str
        What finds the brain: see `physgnn.segmentation.backends.BACKENDS`; "auto"
        takes the first that is installed and serves the contrast.
    contrast : str
        "t1", "t1c" (with contrast agent), "t2" or "flair".
    ventricles : bool
        Whether they are looked for.
    tumour : path, optional
        Points inside of tumours, from which they grow; or a label map to add.
    tumour_labels : str, optional
        Which labels of that map are tumour, such as "1+4"; needed if there are several.
    picture : path, optional
        Where the picture goes, PNG; by default beside the label map.
    any_size : bool
        Whether the brain may have less than 50 or more than 2500 ml.
    affine : str, optional
        "sform" or "qform": which place of the scan is meant where its header has two
        that disagree.
    log : callable
        Called with what was done, and the volumes.

    Returns
    -------
    LabelVolume
        What was written.

    Raises
    ------
    InputError
        If a file or an option cannot be used, or the scan cannot be segmented.
    """
    from physgnn.segmentation import SegmentOptions
    from physgnn.segmentation import segment as segmented
    from physgnn.segmentation.picture import outlines
    from physgnn.segmentation.scan_labels import volumes_line

    out = named_like(out, scan)
    drawn = beside(out, ".png") if picture is None else Path(picture)
    options = SegmentOptions(backend, contrast, ventricles, any_size)
    image = read_image(scan, affine=affine, log=log)
    seeds, mask = _tumour(tumour, tumour_labels, image, log)
    with reading(scan, "an MR scan of a head"):
        labels = segmented(image, options, seeds=seeds, tumour=mask, log=log)
    write_image(out, labels, note="physgnn segment: 1 brain 2 tumour 3 ventricle")
    line = volumes_line(labels)
    with whole_file(drawn) as part:
        outlines(image, labels, line).savefig(part, dpi=110)
    log(f"{line}; look at {drawn}")
    return labels


def _tumour(
    path: str | Path | None, labels: str | None, image: "Image", log: Log
) -> tuple[FloatArray | None, BoolArray | None]:
    """Return the points that a tumour grows from, or where it is."""
    if path is None:
        if labels is not None:
            raise InputError("--tumour-labels needs the label map, --tumour")
        return None, None
    if Path(path).name.lower().endswith(POINTS):
        if labels is not None:
            raise InputError(
                f"{path}: points have no labels: leave --tumour-labels out"
            )
        points = read_points(path, log=log)
        if len(points) == 0:
            raise InputError(f"{path}: the tumour needs one point inside (has none)")
        return points, None
    given = read_segmentation(path, log=log)
    with reading(path, "a label map"):
        inside = given.mask(_named(given, labels))
        return None, nearest_on(image.grid, inside, given.affine)


def _named(given: LabelVolume, labels: str | None) -> tuple[int, ...]:
    """Return the labels of a tumour: those named, or the only one."""
    there = [int(n) for n in np.unique(given.data) if n != 0]
    shown = "+".join(map(str, there[:12]))
    if labels is None:
        if len(there) > 1:
            raise InputError(
                f"which labels are tumour must be named (it has {shown}): give "
                "--tumour-labels, such as 1+4"
            )
        return tuple(there)
    if LABELS.fullmatch(labels) is None:
        raise InputError(f"--tumour-labels must be such as 1+4 (got '{labels}')")
    named = tuple(int(n) for n in labels.split("+"))
    if not set(named) & set(there):
        raise InputError(f"no voxel has one of the labels {labels} (it has {shown})")
    return named


def nearest_on(grid: ImageGrid, mask: BoolArray, affine: FloatArray) -> BoolArray:
    """Return a mask on another grid, by its nearest voxel.

    Raises
    ------
    InputError
        If nothing of it lies on the grid.
    """
    if mask.shape == grid.shape and np.allclose(affine, grid.affine, atol=1e-3):
        return mask
    from scipy import ndimage

    to_index = np.linalg.inv(affine) @ grid.affine
    moved = ndimage.affine_transform(
        mask.astype(np.uint8),
        to_index[:3, :3],
        to_index[:3, 3],
        output_shape=grid.shape,
        order=0,
        mode="grid-constant",
    ).astype(bool)
    if not moved.any():
        raise InputError(
            "nothing of it lies on the scan's voxels: check that both belong together"
        )
    return np.asarray(moved)

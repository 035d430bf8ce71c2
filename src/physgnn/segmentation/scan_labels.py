"""A scan in, a label map out: brain, tumour and ventricles on the scan's voxels."""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.geometry.plausibility import check_volume_ml
from physgnn.geometry.segmentation.labels.label_tables import SEGMENTED
from physgnn.progress import Log, no_log
from physgnn.segmentation.backends import AUTO, BACKENDS, chosen
from physgnn.segmentation.brain_checks import check_brain
from physgnn.segmentation.contrasts import FLUID_IS_BRIGHT
from physgnn.segmentation.orientation import mask_on, upright
from physgnn.segmentation.scan_checks import check_scan
from physgnn.segmentation.stripped import dice, foreground, one_piece
from physgnn.segmentation.tumour import grow_tumour
from physgnn.segmentation.ventricles import find_ventricles

BRAIN_LABEL, TUMOUR_LABEL, VENTRICLE_LABEL = (
    SEGMENTED.labels[name][0] for name in ("brain", "tumour", "ventricle")
)
# A scan whose foreground is so much the brain that a backend finds has no skull.
STRIPPED_DICE = 0.9


@dataclass(frozen=True)
class SegmentOptions:
    """How a scan is segmented.

    Parameters
    ----------
    backend : str
        What finds the brain: a key of `BACKENDS`, or "auto".
    contrast : str
        Of the scan: a key of `FLUID_IS_BRIGHT`.
    ventricles : bool
        Whether they are looked for.
    any_size : bool
        Whether what is found may be no brain by its size, shape and tissue.
    """

    backend: str = AUTO
    contrast: str = "t1"
    ventricles: bool = True
    any_size: bool = False

    def __post_init__(self) -> None:
        for name, value, members in (
            ("backend", self.backend, (AUTO, *BACKENDS)),
            ("contrast", self.contrast, FLUID_IS_BRIGHT),
        ):
            if value not in list(members):
                raise InputError(
                    f"{name} must be one of {', '.join(members)} (got '{value}')"
                )


def segment(
    image: Image,
    options: SegmentOptions | None = None,
    *,
    seeds: FloatArray | None = None,
    tumour: BoolArray | None = None,
    log: Log = no_log,
) -> LabelVolume:
    """Segment brain, tumour and ventricles of an MR scan.

    Parameters
    ----------
    image : Image
        Of any orientation and voxel size.
    options : SegmentOptions, optional
        How.
    seeds : (n, 3) array, optional
        Points inside of tumours, RAS+ mm, from which they grow.
    tumour : boolean array, optional
        Instead, where it is, on the image's voxels.
    log : callable
        Called with what was done and found.

    Returns
    -------
    LabelVolume
        1 brain, 2 tumour, 3 ventricle, on the image's voxels.

    Raises
    ------
    InputError
        If the image is no scan of a head, no backend serves, the brain has no brain's
        size, or the tumour cannot be grown.
    """
    options = options or SegmentOptions()
    check_scan(image, any_size=options.any_size)
    cubes = upright(image)
    brain = _brain(image, cubes, options, log)
    mm3 = float(brain.sum()) * cubes.grid.voxel_volume_mm3
    for line in check_volume_ml(mm3, "brain found", any_size=options.any_size):
        log(line)
    if not options.any_size:
        check_brain(cubes, brain)
    if tumour is not None:
        given = mask_on(cubes.grid, tumour, image.affine)
        grown = brain & given
        _check_given(given, grown, log)
    elif seeds is not None:
        grown = _grown(cubes, brain, seeds, options)
    else:
        grown = np.zeros_like(brain)
    fluid = np.zeros_like(brain)
    if options.ventricles:
        fluid = _ventricles(cubes, brain, grown, options, log)
    labels = np.zeros(image.data.shape, np.int32)
    labels[mask_on(image.grid, brain, cubes.affine)] = BRAIN_LABEL
    inside = labels == BRAIN_LABEL
    labels[mask_on(image.grid, fluid, cubes.affine) & inside] = VENTRICLE_LABEL
    drawn = mask_on(image.grid, grown, cubes.affine) if tumour is None else tumour
    labels[drawn & inside] = TUMOUR_LABEL
    there = set(np.unique(labels).tolist())
    names = {n: name for name, (n,) in SEGMENTED.labels.items() if n in there}
    return LabelVolume(labels, image.affine, names)


def volumes_line(labels: LabelVolume) -> str:
    """Return a line with the volume of each tissue, ml."""
    ml = labels.grid.voxel_volume_mm3 / 1000.0
    counts = {
        "brain, all of it": (labels.data != 0).sum(),
        "ventricles": (labels.data == VENTRICLE_LABEL).sum(),
        "tumour": (labels.data == TUMOUR_LABEL).sum(),
    }
    return "; ".join(
        f"{name}: {n * ml:.1f} ml" if n else f"{name}: none"
        for name, n in counts.items()
    )


def brain_ventricles(
    image: Image, brain: BoolArray, but: BoolArray, *, log: Log = no_log
) -> BoolArray:
    """Return the ventricles of a T1 whose brain is known, on its voxels.

    Parameters
    ----------
    image : Image
        The T1.
    brain, but : boolean arrays
        The brain, and where no ventricle is (tumour and oedema), on its voxels.
    log : callable
        Called with how much was found.

    Raises
    ------
    InputError
        If the image is no scan, or the ventricles cannot be told from the rest.
    """
    check_scan(image, any_size=True)
    cubes = upright(image)
    masks = [mask_on(cubes.grid, m, image.affine) for m in (one_piece(brain), but)]
    found = find_ventricles(cubes, masks[0], but=masks[1])
    if found.reason:
        raise InputError(f"the ventricles cannot be told from the T1: {found.reason}")
    mask = mask_on(image.grid, found.mask, cubes.affine) & brain & ~but
    ml = float(mask.sum()) * image.grid.voxel_volume_mm3 / 1000.0
    log(f"ventricles from intensities: {ml:.1f} ml")
    return mask


def _brain(image: Image, cubes: Image, options: SegmentOptions, log: Log) -> BoolArray:
    """Return the brain on upright cubes: by a backend, or as the scan shows it alone.

    A scan is taken for stripped where what a backend finds is all that there is, or
    where no backend is installed to ask.
    """
    alone = foreground(image)
    if alone is not None:
        shown = mask_on(cubes.grid, alone, image.affine)
        try:
            _, backend = chosen(AUTO, options.contrast)
            found = one_piece(backend.brain(cubes))
        except InputError:
            found = None
        if found is None or dice(shown, found) >= STRIPPED_DICE:
            log("the scan is skull-stripped already: its foreground is the brain")
            return shown
    name, backend = chosen(options.backend, options.contrast)
    log(f"brain found by {name}")
    mask = one_piece(backend.brain(cubes))
    if not mask.any():
        raise InputError(
            f"{name} finds no brain in the scan: check its orientation and contrast"
        )
    return mask


def _grown(
    cubes: Image, brain: BoolArray, seeds: FloatArray, options: SegmentOptions
) -> BoolArray:
    """Return what grows from points; ventricles around them stay out of it."""
    nothing = np.zeros_like(brain)
    bright = FLUID_IS_BRIGHT[options.contrast]
    fluid = find_ventricles(cubes, brain, but=nothing, fluid_is_bright=bright).mask
    index = np.rint(cubes.grid.to_index(seeds)).astype(int)
    index = np.clip(index, 0, np.array(brain.shape) - 1)
    if fluid[tuple(index.T)].any():  # a dark tumour looks like fluid
        fluid = nothing
    return grow_tumour(cubes, brain, seeds, but=fluid)


def _check_given(given: BoolArray, kept: BoolArray, log: Log) -> None:
    if not kept.any():
        raise InputError(
            "the tumour must lie in the brain (no voxel of it does): check that label "
            "map and scan belong together"
        )
    apart = 1.0 - float(kept.sum()) / float(given.sum())
    if apart > 0.005:
        log(f"tumour: {apart:.0%} of it lies outside of the brain found, left out")


def _ventricles(
    cubes: Image, brain: BoolArray, but: BoolArray, options: SegmentOptions, log: Log
) -> BoolArray:
    bright = FLUID_IS_BRIGHT[options.contrast]
    found = find_ventricles(cubes, brain, but=but, fluid_is_bright=bright)
    if found.reason:
        log(f"ventricles: none, {found.reason}")
    return found.mask

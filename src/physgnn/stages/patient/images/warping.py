"""From an image or a plan and a displacement to the deformed one."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.imaging import (
    before_after,
    folding,
    forward_field,
    inverse_field,
    jacobian_image,
    round_trip_mm,
)
from physgnn.imaging import warp as warped
from physgnn.imaging.no_tissue import without_tissue
from physgnn.imaging.reversal import reverse
from physgnn.imaging.slices import middle_of_shift
from physgnn.io.integrity.atomic import whole_file
from physgnn.io.medical.images.formats import (
    OF_LABELS,
    check_holds,
    named_like,
    read_image,
    read_segmentation,
    suffix_of,
    write_image,
)
from physgnn.io.medical.transforms import write_field
from physgnn.io.plans.formats import PLAN_FORMATS, plan_named_like, plan_suffix
from physgnn.io.plans.plan import Plan
from physgnn.io.surfaces.formats import SURFACE_READERS
from physgnn.io.vtk.prediction_file import read_displacement, read_removed
from physgnn.progress import Log, no_log
from physgnn.segmentation.scan_checks import is_label_map
from physgnn.stages.outputs import Output, writes
from physgnn.stages.patient.images.plans import warp_plan

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@writes(
    out=Output(like="image"),
    field=Output((".h5", ".nii.gz", ".nii")),
    jacobian=Output(like="image", may_be_labels=False, of_plans=False),
    slices=Output((".png",)),
)
def warp(
    image: str | Path,
    prediction: str | Path,
    out: str | Path,
    *,
    back: bool = False,
    labels: bool = False,
    interpolation: str | None = None,
    field: Sequence[str | Path] = (),
    jacobian: str | Path | None = None,
    slices: str | Path | None = None,
    affine: str | None = None,
    series: str | None = None,
    log: Log = no_log,
) -> Image | Plan:
    """Deform an image or a plan as a prediction says, and write what goes with it.

    Parameters
    ----------
    image : path
        Image of the rest state, see `physgnn.io.medical.images.formats`; or what was
        planned on it, see `physgnn.io.plans.formats`: points, curves, models, tracts.
        The suffix says which. A plan moves forward, from X to X + u(X), and takes no
        further arguments but `back` and `log`.
    prediction : path
        VTU with the point array ``displacement_mm``.
    out : path
        Image of the deformed state, on the same voxels; in the image's own format if
        the name says none. Of a plan always in its own.
    back : bool
        What comes is of the deformed state, such as a postoperative scan, and goes back
        to the rest state.
    labels : bool
        The image is a label map, as a .seg.nrrd always is.
    interpolation : str, optional
        See `physgnn.imaging.image_warping`. By default linear, but the nearest voxel of
        what looks like a label map, which the log says.
    field : sequence of path
        Where the resampling transform goes: ``.h5`` and ``.nii.gz`` for ITK.
    jacobian : path, optional
        Where the map of det F goes, on the voxels of the rest state.
    slices : path, optional
        PNG of slices before, after and as a checkerboard.
    affine : str, optional
        "sform" or "qform": which place of the image is meant where its header has two
        that disagree.
    series : str, optional
        The UID of the series that is meant, where the image is a folder of DICOM.
    log : callable
        Gets a line on the round trip's error, on what folds, and on why the
        displacement was not called ok if it was not.

    Returns
    -------
    Image
        The deformed image that was written.

    Raises
    ------
    InputError
        If a file cannot be used, or image or plan and mesh do not meet.
    """
    _check_kind(image)
    if plan_suffix(image):
        given = {
            "labels": labels,
            "interpolation": interpolation,
            "field": field,
            "jacobian": jacobian,
            "slices": slices,
            "affine": affine,
            "series": series,
        }
        _refuse(image, [name for name, value in given.items() if value])
        return warp_plan(image, prediction, out, back=back, log=log)
    out = named_like(out, image)
    if jacobian is not None:
        jacobian = named_like(jacobian, image, labels=False)
    labels = labels or suffix_of(image) in OF_LABELS
    mesh, u = read_displacement(prediction, log=log)
    removed = read_removed(prediction)
    if back:
        mesh, u = reverse(mesh, u)
    read = read_segmentation if labels else read_image
    before = read(image, affine=affine, series=series, log=log)
    check_holds(out, labels=isinstance(before, LabelVolume))
    guessed = not labels and interpolation is None and is_label_map(before.data)
    if guessed:
        interpolation = "nearest"
    inverse = inverse_field(mesh, u, before.grid)
    if removed is not None and not back:
        before = without_tissue(before, removed)
    after = warped(before, inverse, interpolation=interpolation)
    if removed is not None and back:
        after = without_tissue(after, removed)
    write_image(out, after)
    error = round_trip_mm(forward_field(mesh, u, before.grid), inverse)
    if len(error):
        log(
            f"round trip inside the brain: {error.mean():.4f} mm on average, "
            f"{error.max():.3f} mm at most"
        )
    log(str(folding(mesh, u, inverse)))
    if guessed:
        log(
            f"{image} looks like a label map: the nearest voxels were taken, as with "
            "--labels; if it is none, give --interpolation linear"
        )
    for path in field:
        write_field(path, inverse)
    if jacobian is not None:
        write_image(jacobian, jacobian_image(mesh, u, before.grid))
    if slices is not None:
        _save_figure(slices, before_after(before, after, middle_of_shift(mesh, u)))
    return after


def result_name(out: str | Path, image: str | Path) -> Path:
    """Return the name of what `warp` writes."""
    named = plan_named_like if plan_suffix(image) else named_like
    return named(out, image)


def _check_kind(image: str | Path) -> None:
    """Raise InputError if a file is a model of a format that is only read."""
    suffix = Path(image).suffix.lower()
    models = [name for name in SURFACE_READERS if name in PLAN_FORMATS]
    if suffix in SURFACE_READERS and suffix not in models:
        raise InputError(
            f"{image}: a model is warped as {', '.join(models)} (got '{suffix}'): save "
            "it as one of these"
        )


def _refuse(plan: str | Path, options: Sequence[str]) -> None:
    if options:
        raise InputError(
            f"{plan}: {', '.join(f'--{name}' for name in options)} is for images (this "
            f"is a plan, {plan_suffix(plan)}): leave it out"
        )


def _save_figure(path: str | Path, figure: "Figure") -> None:
    with whole_file(Path(path)) as part:
        figure.savefig(part, dpi=120)

"""From the error of every point to images of it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.imaging.voxel_fields import rasterize
from physgnn.io.medical.images.formats import named_like, read_image, write_image
from physgnn.io.vtk.error_fields import read_error_fields
from physgnn.progress import Log, no_log
from physgnn.stages.outputs import Output, writes


@dataclass(frozen=True, eq=False)
class UncertaintyImages:
    """Images on one grid; 0 outside of the brain.

    Attributes
    ----------
    deviation_mm : Image
        Standard deviation of the displacement.
    wrong : Image
        Probability that the position is wrong by more than `wrong_mm`.
    inside : boolean array
        Where there is brain.
    wrong_mm : float
        As asked for.
    """

    deviation_mm: Image
    wrong: Image
    inside: BoolArray
    wrong_mm: float


@writes(
    out=Output(like="image", may_be_labels=False),
    wrong=Output(like="image", may_be_labels=False),
)
def uncertainty(
    prediction: str | Path,
    image: str | Path,
    out: str | Path,
    *,
    wrong: str | Path | None = None,
    wrong_mm: float = 2.0,
    deformed: bool = False,
    affine: str | None = None,
    series: str | None = None,
    log: Log = no_log,
) -> UncertaintyImages:
    """Write how far to trust a displacement on the voxels of the patient's image.

    Within a tetrahedron both are linear, as the displacement is. Outside of the brain
    they are 0: nothing is said there.

    Parameters
    ----------
    prediction : path
        VTU with ``deviation_mm``, as `physgnn.register` writes it; its
        ``covariance_mm2`` gives the probability
        (`physgnn.prediction.wrong_position`). Without it the error is taken to be alike
        in all directions, and the log says so.
    image : path
        The patient's image, such as the T1, whose voxels are taken.
    out : path
        Where the standard deviation goes, mm; in the image's own format if the name
        says none.
    wrong : path, optional
        Where the probability goes that the position is wrong by more than `wrong_mm`.
    wrong_mm : float
        mm, > 0.
    deformed : bool
        Show brain where it is now, to lay over a warped image; otherwise where it was.
    affine, series
        As of `physgnn.warp`.
    log : callable
        Gets a line on the model, and on how much of the brain is how uncertain.

    Returns
    -------
    UncertaintyImages
        What was written.

    Raises
    ------
    InputError
        If a file cannot be used, says nothing of the error of each point, or image and
        mesh do not meet.
    """
    from physgnn.prediction.wrong_position import isotropic, probability_beyond

    given = [path for path in (out, wrong) if path is not None]
    paths = [named_like(path, image, labels=False) for path in given]
    found = read_error_fields(prediction, log=log)
    covariance = found.covariance_mm2
    if covariance is None:
        covariance = isotropic(found.deviation_mm)
        log(
            f"{prediction} has no 'covariance_mm2': errors are taken to be Gaussian "
            "and alike in all directions"
        )
    chance = probability_beyond(covariance, wrong_mm)
    grid = read_image(image, affine=affine, series=series, log=log).grid
    points = found.mesh.points + (found.displacement if deformed else 0.0)
    values = np.stack([found.deviation_mm, chance], axis=1)
    fields, cell = rasterize(points, found.mesh.cells, values, grid)
    made = UncertaintyImages(
        _image(fields[..., 0], grid.affine),
        _image(fields[..., 1], grid.affine),
        cell >= 0,
        wrong_mm,
    )
    _check_and_tell(made, log)
    for path, part in zip(paths, (made.deviation_mm, made.wrong), strict=False):
        write_image(path, part)
    return made


def _image(data: FloatArray, affine: FloatArray) -> Image:
    return Image(data.astype(np.float32), affine)


def _check_and_tell(made: UncertaintyImages, log: Log) -> None:
    if not made.inside.any():
        raise InputError(
            "mesh and image do not meet: check that both are in the same world "
            "coordinates, mm"
        )
    deviation, wrong = (
        np.asarray(image.data, np.float64)[made.inside]
        for image in (made.deviation_mm, made.wrong)
    )
    log(
        f"standard deviation {deviation.mean():.2f} mm on average, "
        f"{deviation.max():.2f} mm at most"
    )
    log(
        f"wrong by more than {made.wrong_mm:g} mm: {wrong.mean():.1%} on average, more "
        f"likely than not in {(wrong > 0.5).mean():.1%} of the brain"
    )

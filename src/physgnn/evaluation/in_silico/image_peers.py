"""What registrations are compared with that take two images: SimpleITK's, by intensity.

Both begin with the rigid motion that has the most mutual information, and go from
coarse to fine. Free-form deformation: cubic B-splines on finer and finer control
points, each of what the last left, by mutual information, which does not ask for equal
contrast (Rueckert et al., IEEE TMI 18, 1999; Mattes et al., IEEE TMI 22, 2003). Demons
with symmetric forces (Vercauteren et al., NeuroImage 45, 2009) compare grey values, so
histograms are matched before. Only the brain counts, with a rim that shows where it
ends.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import SimpleITK as sitk

from physgnn.arrays import FloatArray
from physgnn.evaluation.in_silico.simulated_images import Scan
from physgnn.imaging.transforms import points_to_ras, to_itk

RIM_MM = 6.0
BINS, SEED = 16, 1
RIGID_STEPS, RIGID_SAMPLED = 60, 0.2  # of each level
SHRINK = (4, 2, 1)
DEMON_STEPS, DEMON_BLUR = (80, 60, 40), 1.5  # voxels, of the displacement
LEVELS, MATCHED = 128, 15  # of histograms: bins, and quantiles that are made equal


@dataclass(frozen=True)
class SplineLevel:
    """One level of a free-form deformation.

    Attributes
    ----------
    shrink : int
        Voxels that become one, along each axis.
    control_mm : float
        Between control points, about.
    sampled : float
        Fraction of the voxels that count.
    evaluations : int
        Of the metric, at most: the few samples are fitted too closely by more.
    """

    shrink: int
    control_mm: float
    sampled: float
    evaluations: int


SPLINE_LEVELS = (
    SplineLevel(4, 48.0, 1.0, 30),
    SplineLevel(2, 24.0, 0.3, 12),
    SplineLevel(1, 16.0, 0.05, 10),
)


def b_spline(before: Scan, after: Scan, points: FloatArray) -> FloatArray:
    """Return how points move by a free-form deformation.

    Parameters
    ----------
    before, after : Scan
        On voxels of the same size; after the shift in any contrast.
    points : (n, 3) array
        Of the rest state, mm, RAS+.
    """
    fixed, moving = to_itk(before.image), to_itk(after.image)
    extent = np.multiply(fixed.GetSize(), fixed.GetSpacing())
    found = [_rigid(before, after)]
    for level in SPLINE_LEVELS:
        there = sitk.Resample(moving, fixed, sitk.CompositeTransform(found))
        cells = np.maximum(1, np.round(extent / level.control_mm)).astype(int)
        spline = sitk.BSplineTransformInitializer(fixed, cells.tolist())
        method = _by_mutual_information(before, level.sampled)
        method.SetInitialTransform(spline, inPlace=True)
        method.SetOptimizerAsLBFGSB(
            numberOfIterations=level.evaluations,
            maximumNumberOfFunctionEvaluations=level.evaluations,
        )
        method.Execute(*(_shrunk(image, level.shrink) for image in (fixed, there)))
        found.append(spline)
    return _moved(found, points)


def demons(before: Scan, after: Scan, points: FloatArray) -> FloatArray:
    """Return how points move by demons; parameters as of `b_spline`."""
    rigid, fixed = _rigid(before, after), to_itk(before.image)
    moving = sitk.Resample(to_itk(after.image), fixed, rigid)
    moving = sitk.HistogramMatching(moving, fixed, LEVELS, MATCHED, True)
    start: tuple[Any, ...] = ()
    for shrink, steps in zip(SHRINK, DEMON_STEPS, strict=True):
        coarse = [_shrunk(image, shrink) for image in (fixed, moving)]
        method = sitk.FastSymmetricForcesDemonsRegistrationFilter()
        method.SetNumberOfIterations(steps)
        method.SetStandardDeviations(DEMON_BLUR)
        field = method.Execute(*coarse, *(sitk.Resample(f, coarse[0]) for f in start))
        start = (field,)
    field = sitk.Cast(field, sitk.sitkVectorFloat64)
    return _moved([rigid, sitk.DisplacementFieldTransform(field)], points)


IMAGE_METHODS: Mapping[str, Callable[[Scan, Scan, FloatArray], FloatArray]] = {
    "B-spline": b_spline,
    "demons": demons,
}
"""From the scans before and after to the displacement of points, mm."""


def _rigid(before: Scan, after: Scan) -> sitk.Transform:
    """Return the rigid motion from the first scan to the second."""
    fixed = to_itk(before.image)
    middle = fixed.TransformContinuousIndexToPhysicalPoint(
        [(n - 1) / 2 for n in fixed.GetSize()]
    )
    found = sitk.Euler3DTransform(middle)
    method = _by_mutual_information(before, RIGID_SAMPLED)
    voxel = float(before.image.grid.voxel_mm.max())
    method.SetShrinkFactorsPerLevel(SHRINK)
    method.SetSmoothingSigmasPerLevel([voxel * (one - 1) / 2 for one in SHRINK])
    method.SetInitialTransform(found, inPlace=True)
    method.SetOptimizerAsRegularStepGradientDescent(1.0, 1e-3, RIGID_STEPS)
    method.SetOptimizerScalesFromPhysicalShift()
    method.Execute(fixed, to_itk(after.image))
    return found


def _by_mutual_information(
    before: Scan, sampled: float
) -> sitk.ImageRegistrationMethod:
    """Return a registration that looks at the brain and its rim."""
    method = sitk.ImageRegistrationMethod()
    method.SetMetricAsMattesMutualInformation(BINS)
    radius = np.round(RIM_MM / before.image.grid.voxel_mm).astype(int).tolist()
    method.SetMetricFixedMask(sitk.BinaryDilate(to_itk(before.brain), radius))
    if sampled < 1.0:
        method.SetMetricSamplingStrategy(method.RANDOM)
        method.SetMetricSamplingPercentage(sampled, SEED)
    method.SetInterpolator(sitk.sitkLinear)
    return method


def _shrunk(image: sitk.Image, times: int) -> sitk.Image:
    if times == 1:
        return image
    smooth = sitk.SmoothingRecursiveGaussian(image, times / 2 * image.GetSpacing()[0])
    small: sitk.Image = sitk.Shrink(smooth, [times] * 3)
    return small


def _moved(transforms: list[sitk.Transform], points: FloatArray) -> FloatArray:
    """Return the displacement of points by transforms, the last one first."""
    total = sitk.CompositeTransform(transforms)
    lps = points_to_ras(points, "LPS")  # the same signs turn, there and back
    to = np.array([total.TransformPoint(x) for x in lps.tolist()])
    moved: FloatArray = points_to_ras(to, "LPS") - points
    return moved

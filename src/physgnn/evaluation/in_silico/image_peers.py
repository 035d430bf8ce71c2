"""What registrations are compared with that take two images: SimpleITK's, by intensity.

Both begin with the rigid motion that has the most mutual information, and go from
coarse to fine. Free-form deformation: cubic B-splines, at last on control points 16 mm
apart, by mutual information, which does not ask for equal contrast (Rueckert et al.,
IEEE TMI 18, 1999; Mattes et al., IEEE TMI 22, 2003). Demons with symmetric forces
(Vercauteren et al., NeuroImage 45, 2009) compare grey values, so histograms are matched
before. Only the brain counts, with a rim that shows where it ends.
"""

from collections.abc import Callable, Mapping

import numpy as np
import SimpleITK as sitk

from physgnn.arrays import FloatArray
from physgnn.evaluation.in_silico.simulated_images import Scan
from physgnn.imaging.transforms import points_to_ras, to_itk

SHRINK = (4, 2, 1)
CONTROL_MM = 16.0
RIM_MM = 6.0
BINS, SAMPLED, SEED = 32, 0.2, 1
RIGID_STEPS, SPLINE_STEPS = 60, 30  # of each level
DEMON_STEPS, DEMON_BLUR = (80, 60, 40), 1.5  # voxels, of the displacement
LEVELS, MATCHED = 128, 15  # of histograms: bins, and quantiles that are made equal


def b_spline(before: Scan, after: Scan, points: FloatArray) -> FloatArray:
    """Return how points move by a free-form deformation.

    Parameters
    ----------
    before, after : Scan
        On voxels of the same size; after the shift in any contrast.
    points : (n, 3) array
        Of the rest state, mm, RAS+.
    """
    fixed = to_itk(before.image)
    rigid = _rigid(before, after)
    extent = np.multiply(fixed.GetSize(), fixed.GetSpacing())
    cells = np.maximum(1, np.round(extent / CONTROL_MM / SHRINK[0])).astype(int)
    spline = sitk.BSplineTransformInitializer(fixed, cells.tolist())
    method = _by_mutual_information(before)
    method.SetMovingInitialTransform(rigid)
    method.SetInitialTransformAsBSpline(
        spline, inPlace=True, scaleFactors=[SHRINK[0] // one for one in SHRINK]
    )
    method.SetOptimizerAsLBFGS2(numberOfIterations=SPLINE_STEPS)
    method.Execute(fixed, to_itk(after.image))
    return _moved(sitk.CompositeTransform([rigid, spline]), points)


def demons(before: Scan, after: Scan, points: FloatArray) -> FloatArray:
    """Return how points move by demons; parameters as of `b_spline`."""
    rigid, fixed = _rigid(before, after), to_itk(before.image)
    moving = sitk.Resample(to_itk(after.image), fixed, rigid)
    moving = sitk.HistogramMatching(moving, fixed, LEVELS, MATCHED, True)
    field = None
    for shrink, steps in zip(SHRINK, DEMON_STEPS, strict=True):
        coarse = [_shrunk(image, shrink) for image in (fixed, moving)]
        method = sitk.FastSymmetricForcesDemonsRegistrationFilter()
        method.SetNumberOfIterations(steps)
        method.SetStandardDeviations(DEMON_BLUR)
        start = [] if field is None else [sitk.Resample(field, coarse[0])]
        field = method.Execute(*coarse, *start)
    found = sitk.DisplacementFieldTransform(sitk.Cast(field, sitk.sitkVectorFloat64))
    return _moved(sitk.CompositeTransform([rigid, found]), points)


IMAGE_METHODS: Mapping[str, Callable[[Scan, Scan, FloatArray], FloatArray]] = {
    "B-spline": b_spline,
    "demons": demons,
}
"""From the scans before and after to the displacement of points, mm."""


def _rigid(before: Scan, after: Scan) -> sitk.Euler3DTransform:
    """Return the rigid motion from the first scan to the second."""
    fixed = to_itk(before.image)
    middle = fixed.TransformContinuousIndexToPhysicalPoint(
        [(n - 1) / 2 for n in fixed.GetSize()]
    )
    found = sitk.Euler3DTransform(middle)
    method = _by_mutual_information(before)
    method.SetInitialTransform(found, inPlace=True)
    method.SetOptimizerAsRegularStepGradientDescent(1.0, 1e-3, RIGID_STEPS)
    method.SetOptimizerScalesFromPhysicalShift()
    method.Execute(fixed, to_itk(after.image))
    return found


def _by_mutual_information(before: Scan) -> sitk.ImageRegistrationMethod:
    """Return a registration from coarse to fine that looks at the brain and its rim."""
    method = sitk.ImageRegistrationMethod()
    method.SetMetricAsMattesMutualInformation(BINS)
    method.SetMetricFixedMask(_rim(before))
    method.SetMetricSamplingStrategy(method.RANDOM)
    method.SetMetricSamplingPercentage(SAMPLED, SEED)
    method.SetInterpolator(sitk.sitkLinear)
    voxel = float(before.image.grid.voxel_mm.max())
    method.SetShrinkFactorsPerLevel(SHRINK)
    method.SetSmoothingSigmasPerLevel([voxel * (one - 1) / 2 for one in SHRINK])
    return method


def _rim(scan: Scan) -> sitk.Image:
    radius = np.round(RIM_MM / scan.image.grid.voxel_mm).astype(int).tolist()
    return sitk.BinaryDilate(to_itk(scan.brain), radius)


def _shrunk(image: sitk.Image, times: int) -> sitk.Image:
    if times == 1:
        return image
    smooth = sitk.SmoothingRecursiveGaussian(image, times / 2 * image.GetSpacing()[0])
    return sitk.Shrink(smooth, [times] * 3)


def _moved(transform: sitk.Transform, points: FloatArray) -> FloatArray:
    lps = points_to_ras(points, "LPS")  # the same signs turn, there and back
    to = np.array([transform.TransformPoint(x) for x in lps.tolist()])
    moved: FloatArray = points_to_ras(to, "LPS") - points
    return moved

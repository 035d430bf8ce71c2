"""Where ventricles may be: those of the MNI152 template, brought to a brain.

The template comes inside nilearn's wheel, with maps of how much grey and white matter
each voxel holds (Fonov et al., NeuroImage 54, 2011). What is neither, inside of its
brain, is fluid. What holds `BODIES_MM` or lies in `BALLS_MM` is ventricle; all other
fluid is in fissures, sulci and cisterns.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import SimpleITK as sitk
from numpy.typing import NDArray
from scipy import ndimage

from physgnn.arrays import BoolArray, FloatArray
from physgnn.geometry.image import Image
from physgnn.imaging.transforms import from_itk, to_itk

STEP_MM = 2
# A voxel is fluid where grey and white matter have less than this together.
SOLID = 0.5
# A point in the body of each lateral ventricle, mm: their fluid has no way to the
# cisterns.
BODIES_MM = ((10, 5, 20), (-10, 5, 20))
# Third and fourth ventricle and inferior horns are open to cisterns in the template:
# fluid in balls, centre and radius, mm.
BALLS_MM = (
    ((0, -9, 1), 9.0),
    ((0, -45, -33), 9.0),
    ((31, -12, -20), 7.0),
    ((-31, -12, -20), 7.0),
)
# Voxels for the registration, mm, and how many mm it blurs by.
COARSE_MM, BLUR_MM = 4.0, 2.0
SHRINK = (2, 1)


@dataclass(frozen=True, eq=False)
class Prior:
    """Distances on the voxels of a brain, mm.

    Attributes
    ----------
    to_ventricles, to_other_fluid : float32 arrays
        To the template's ventricles, and to its other fluid; 0 inside.
    """

    to_ventricles: NDArray[np.float32]
    to_other_fluid: NDArray[np.float32]


def ventricle_prior(image: Image, brain: BoolArray) -> Prior:
    """Bring the template's ventricles to a brain by an affine map.

    The map makes the mutual information of the two brains largest (Mattes et al., IEEE
    TMI 22, 2003), from the one that brings their moments together; so it holds for any
    contrast.

    Parameters
    ----------
    image : Image
        On upright cubes.
    brain : boolean array
        On its voxels.
    """
    t1, inside, ventricles, other = _template()
    fixed = _coarse(image, brain)
    moving = _coarse(t1, inside)
    found = _registered(fixed, moving)
    like = to_itk(Image(np.zeros(brain.shape, np.uint8), image.affine))
    fields = [
        from_itk(
            sitk.Resample(
                to_itk(Image(distance, t1.affine)), like, found, sitk.sitkLinear, 99.0
            )
        )
        for distance in (ventricles, other)
    ]
    return Prior(*(np.asarray(field.data, np.float32) for field in fields))


@cache
def _template() -> tuple[Image, BoolArray, NDArray[np.float32], NDArray[np.float32]]:
    """Return the T1, its brain, and the distances to ventricles and other fluid."""
    # nilearn takes seconds to import: only this function needs it
    from nilearn.datasets import (
        load_mni152_brain_mask,
        load_mni152_gm_template,
        load_mni152_template,
        load_mni152_wm_template,
    )

    t1, grey, white, mask = (
        load(resolution=STEP_MM)
        for load in (
            load_mni152_template,
            load_mni152_gm_template,
            load_mni152_wm_template,
            load_mni152_brain_mask,
        )
    )
    inside = ndimage.binary_fill_holes(np.asarray(mask.dataobj) > 0)
    solid = np.asarray(grey.dataobj, float) + np.asarray(white.dataobj, float)
    image = Image(np.asarray(t1.dataobj, np.float32), t1.affine)
    fluid = inside & (solid < SOLID)
    ventricles = _holding(fluid, image)
    distances = [
        ndimage.distance_transform_edt(~m, sampling=STEP_MM).astype(np.float32)
        for m in (ventricles, (fluid | ~inside) & ~ventricles)
    ]
    return image, inside, distances[0], distances[1]


def _holding(fluid: BoolArray, image: Image) -> BoolArray:
    """Return the pieces of fluid that hold the bodies, and the fluid in the balls."""
    pieces, _ = ndimage.label(fluid)
    index = np.rint(image.grid.to_index(np.array(BODIES_MM, float))).astype(int)
    x = image.grid.to_world(np.argwhere(fluid))
    near = [np.linalg.norm(x - centre, axis=1) < radius for centre, radius in BALLS_MM]
    held = np.isin(pieces, pieces[tuple(index.T)]) & fluid
    held[fluid] |= np.any(near, axis=0)
    return held


def _coarse(image: Image, brain: BoolArray) -> sitk.Image:
    """Return the brain alone, background 0, blurred and on coarse cubes."""
    voxel = float(image.grid.voxel_mm[0])
    data = np.where(brain, np.asarray(image.data, np.float32), np.nan)
    low, high = np.nanpercentile(data, (0.5, 99.5))
    # 0.2 at least, so that the darkest tissue still stands out of the background
    data = np.clip((data - low) / max(float(high - low), 1e-12), 0.0, 1.0) * 0.8 + 0.2
    data = ndimage.gaussian_filter(np.nan_to_num(data), BLUR_MM / voxel)
    every = max(1, round(COARSE_MM / voxel))
    affine: FloatArray = image.affine @ np.diag([every, every, every, 1.0])
    return to_itk(Image(data[::every, ::every, ::every].astype(np.float32), affine))


def _registered(fixed: sitk.Image, moving: sitk.Image) -> sitk.Transform:
    """Return the affine map from the places of one image to those of another."""
    start = sitk.CenteredTransformInitializer(
        fixed,
        moving,
        sitk.AffineTransform(3),
        sitk.CenteredTransformInitializerFilter.MOMENTS,
    )
    method = sitk.ImageRegistrationMethod()
    method.SetNumberOfThreads(1)  # so that sums have one order
    method.SetMetricAsMattesMutualInformation(32)
    method.SetMetricSamplingStrategy(method.NONE)
    method.SetInterpolator(sitk.sitkLinear)
    method.SetOptimizerAsRegularStepGradientDescent(1.0, 1e-3, 60)
    method.SetOptimizerScalesFromPhysicalShift()
    method.SetShrinkFactorsPerLevel(SHRINK)
    method.SetSmoothingSigmasPerLevel((0.0,) * len(SHRINK))
    method.SetInitialTransform(start, inPlace=False)
    found: sitk.Transform = method.Execute(fixed, moving)
    return found

"""Heads whose brain is known: the MNI152 template in a skull and a scalp of shells."""

from functools import cache

import numpy as np
from nilearn.datasets import load_mni152_brain_mask, load_mni152_template
from scipy import ndimage

from physgnn.arrays import BoolArray, FloatArray
from physgnn.geometry.image import Image

# Outer distance from the brain, mm, and intensity, white matter being about 0.8.
SHELLS = ((1.5, 0.25), (8.0, 0.08), (15.0, 0.9))
PAD = 16


@cache
def template() -> tuple[Image, BoolArray]:
    """Return the brain alone at 1 mm, and its mask."""
    t1, mask = (f(resolution=1) for f in (load_mni152_template, load_mni152_brain_mask))
    inside = ndimage.binary_fill_holes(np.asarray(mask.dataobj) > 0)
    data = np.where(inside, np.asarray(t1.dataobj, np.float32), 0.0)
    return Image(data, t1.affine), inside


@cache
def head() -> tuple[Image, BoolArray]:
    """Return the template in shells of fluid, bone and fat, and the brain's mask."""
    t1, mask = template()
    mask = np.pad(mask, PAD)
    data = np.pad(np.asarray(t1.data), PAD)
    away = ndimage.distance_transform_edt(~mask)
    low = 0.0
    for high, value in SHELLS:
        data[(away > low) & (away <= high)] = value * data.max() / 1.0
        low = high
    data = ndimage.gaussian_filter(data, 0.6) + np.random.default_rng(0).normal(
        0.0, 0.01 * data.max(), data.shape
    )
    affine = t1.affine.copy()
    affine[:3, 3] -= PAD * affine[:3, :3].sum(axis=1)
    return Image(data.astype(np.float32), affine), mask


def seen(image: Image, mask: BoolArray, axes: FloatArray) -> tuple[Image, BoolArray]:
    """Return image and mask on voxels with these axes (columns, mm) around the head."""
    middle = image.grid.to_world(np.array(image.data.shape)[None] / 2.0)[0]
    sizes = np.linalg.norm(axes, axis=0)
    shape = np.ceil(250.0 / sizes).astype(int)
    affine = np.eye(4)
    affine[:3, :3] = axes
    affine[:3, 3] = middle - axes @ (shape - 1) / 2.0
    to_index = np.linalg.inv(image.affine) @ affine
    data, inside = (
        ndimage.affine_transform(
            np.asarray(values, np.float32),
            to_index[:3, :3],
            to_index[:3, 3],
            output_shape=tuple(shape),
            order=1,
        )
        for values in (image.data, mask)
    )
    return Image(data, affine), inside > 0.5

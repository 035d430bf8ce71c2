"""A brain's scan before a shift, and one after it by another scanner, as simulated.

Tissue comes from the grey and white matter of the MNI152 template, which the bundled
brain was made of (ICBM 2009: Fonov et al., NeuroImage 54, 2011), and from the mesh: the
tumour is the mesh's, the rest within the brain is fluid. Each tissue has one grey value
(`Contrast`); a smooth bias multiplies it and noise is added. The skull is stripped.

An image of a shift shows at x the tissue that was at X, by the inverse of the true
displacement (`physgnn.imaging.field`). Where tissue was removed there is fluid.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from physgnn.arrays import FloatArray
from physgnn.geometry import TetMesh
from physgnn.geometry.image import Image, ImageGrid
from physgnn.geometry.regions import TUMOUR
from physgnn.imaging.voxel_fields import rasterize

SOLID = 0.5  # of grey and white matter together; less is fluid
BLUR_MM = 1.0  # of tissue, since a voxel shows more than its centre
BIAS_MM = 40.0  # over which a bias changes


@dataclass(frozen=True)
class Contrast:
    """How a scanner shows tissue; outside of the brain is 0.

    Attributes
    ----------
    fluid, grey, white, tumour : float
        Grey value of each tissue.
    bias : float
        How much these change from place to place, as a standard deviation of 1.
    noise : float
        Standard deviation of each voxel.
    """

    fluid: float
    grey: float
    white: float
    tumour: float
    bias: float
    noise: float


PREOPERATIVE = Contrast(0.25, 0.65, 1.0, 0.45, bias=0.02, noise=0.02)
# As a scanner of low field in the operating theatre may show it: grey and white matter
# are nearer to each other, and there is more bias and noise.
INTRAOPERATIVE = Contrast(0.15, 0.50, 0.68, 0.35, bias=0.05, noise=0.03)


@dataclass(frozen=True, eq=False)
class Scan:
    """An image and where its brain is.

    Attributes
    ----------
    image : Image
        Grey values, float32.
    brain : Image
        1 in the brain and its cavities, else 0.
    """

    image: Image
    brain: Image


def simulated_scan(
    mesh: TetMesh,
    displacement: FloatArray,
    grid: ImageGrid,
    contrast: Contrast,
    *,
    seed: int = 0,
) -> Scan:
    """Return a scan of a brain.

    Parameters
    ----------
    mesh : TetMesh
        The rest state of what is there; a hole in it is filled with fluid.
    displacement : (n_points, 3) array
        Its shift, mm; zeros before one.
    grid : ImageGrid
        Of the scan.
    contrast : Contrast
        How it shows tissue.
    seed : int
        Of bias and noise.
    """
    rng = np.random.default_rng(seed)
    back, cell = rasterize(mesh.points + displacement, mesh.cells, -displacement, grid)
    inside = cell >= 0
    brain = ndimage.binary_fill_holes(inside)
    X = grid.to_world(np.argwhere(inside)) + back[inside]
    tumour = mesh.region[cell[inside]] == TUMOUR
    grey, white = (np.where(tumour, 0.0, share) for share in _matter_at(X))
    tissue = (
        contrast.fluid * (1.0 - grey - white - tumour)
        + contrast.grey * grey
        + contrast.white * white
        + contrast.tumour * tumour
    )
    data = np.zeros(grid.shape)
    data[brain] = contrast.fluid
    data[inside] = tissue
    data *= 1.0 + contrast.bias * _smooth(grid, rng)
    data += contrast.noise * rng.normal(size=grid.shape) * brain
    return Scan(
        Image(data.astype(np.float32), grid.affine),
        Image(brain.astype(np.uint8), grid.affine),
    )


def _smooth(grid: ImageGrid, rng: np.random.Generator) -> FloatArray:
    """Return a smooth field of mean 0 and deviation 1."""
    field = ndimage.gaussian_filter(
        rng.normal(size=grid.shape), BIAS_MM / grid.voxel_mm
    )
    found: FloatArray = (field - field.mean()) / field.std()
    return found


def _matter_at(points: FloatArray) -> list[FloatArray]:
    """Return the shares of grey and of white matter at points of the rest state."""
    images = _template()
    index = images[0].grid.to_index(points).T
    return [
        ndimage.map_coordinates(image.data, index, output=np.float64, order=1)
        for image in images
    ]


@cache
def _template() -> tuple[Image, Image]:
    """Return the template's grey and white matter, 1 where they prevail, blurred."""
    # nilearn takes seconds to import: only this function needs it
    from nilearn.datasets import load_mni152_gm_template, load_mni152_wm_template

    images = [load(1) for load in (load_mni152_gm_template, load_mni152_wm_template)]
    grey, white = (np.asarray(image.dataobj, np.float32) for image in images)
    solid, whiter = grey + white > SOLID, white > grey
    affine = images[0].affine

    def blurred(mask: NDArray[np.bool_]) -> Image:
        return Image(ndimage.gaussian_filter(mask.astype(np.float32), BLUR_MM), affine)

    return blurred(solid & ~whiter), blurred(solid & whiter)

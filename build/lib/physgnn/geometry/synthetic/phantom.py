"""The bundled case: the MNI152 brain with a spherical tumour under its cortex.

The template comes inside nilearn's wheel, so nothing is downloaded (Fonov et al.,
NeuroImage 54, 2011: ICBM 2009 nonlinear symmetric).
"""

import warnings
from dataclasses import dataclass

import numpy as np
import pyacvd
import pyvista as pv
from scipy import ndimage
from skimage.measure import marching_cubes

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.surface import Surface
from physgnn.geometry.surfaces.checks import check_nested, check_surface
from physgnn.geometry.surfaces.repair import repaired

VOXEL_MM = 2
CLOSING_MM = 10.0  # fills the sulci, keeps the cleft between cerebrum and cerebellum
SMOOTHING_MM = 3.0
# High on the right, frontal: an easily reached convexity, like the published case.
CRANIOTOMY_DIRECTION = (0.55, 0.35, 0.75)


@dataclass(frozen=True, eq=False)
class Phantom:
    """A brain, its tumours and where a surgeon would open the skull.

    Attributes
    ----------
    brain : Surface
        Closed, outward, RAS+ mm.
    tumours : tuple of Surface
        Closed, outward, inside the brain.
    tumour_centre : (3,) array
        Centre of the tumour, mm.
    craniotomy_point : (3,) array
        The point of the cortex above the tumour, mm.
    """

    brain: Surface
    tumours: tuple[Surface, ...]
    tumour_centre: FloatArray
    craniotomy_point: FloatArray


def mni152_phantom(
    *,
    n_points: int = 700,
    tumour_radius_mm: float = 11.0,
    depth_mm: float = 6.0,
) -> Phantom:
    """Build the bundled case; the same arguments always give the same case.

    Parameters
    ----------
    n_points : int
        About how many points the brain's surface has, 300–5000.
    tumour_radius_mm : float
        Radius of the spherical tumour, 4–20 mm.
    depth_mm : float
        Brain tissue between the tumour and the cortex above it, ≥ 3 mm.

    Returns
    -------
    Phantom
        The surfaces of brain and tumour, and the place of the craniotomy; mm.

    Raises
    ------
    InputError
        If an argument is out of range.
    """
    for name, value, low, high in (
        ("n_points", n_points, 300, 5000),
        ("tumour_radius_mm", tumour_radius_mm, 4.0, 20.0),
        ("depth_mm", depth_mm, 3.0, 30.0),
    ):
        if not low <= value <= high:
            raise InputError(f"{name} must be in {low}…{high} (got {value})")
    brain, _ = check_surface(_brain_surface(n_points), "brain")
    cortex = outermost(brain, np.array(CRANIOTOMY_DIRECTION))
    inward = brain.points.mean(axis=0) - cortex
    inward /= np.linalg.norm(inward)
    centre = cortex + (depth_mm + tumour_radius_mm) * inward
    tumour, _ = check_surface(sphere(centre, tumour_radius_mm), "tumour")
    check_nested(brain, [tumour])
    return Phantom(brain, (tumour,), centre, cortex)


def _brain_surface(n_points: int) -> Surface:
    """Close the sulci of the brain mask and cover it with uniform triangles."""
    mask, affine = _brain_mask()
    margin = int(np.ceil(CLOSING_MM / VOXEL_MM)) + 2
    mask = np.pad(mask, margin)
    inside = ndimage.distance_transform_edt(~mask, sampling=VOXEL_MM) <= CLOSING_MM
    closed = ndimage.distance_transform_edt(inside, sampling=VOXEL_MM) > CLOSING_MM
    closed = ndimage.binary_fill_holes(closed)
    smooth = ndimage.gaussian_filter(closed.astype(float), SMOOTHING_MM / VOXEL_MM)
    voxels, faces, _, _ = marching_cubes(smooth, 0.5)  # type: ignore[no-untyped-call]
    points = (voxels - margin) @ affine[:3, :3].T + affine[:3, 3]
    fine = pv.PolyData.from_regular_faces(points, faces)
    coarse = _uniform(fine, n_points)
    points = np.asarray(coarse.points, dtype=np.float64)
    return repaired(Surface(points, coarse.regular_faces.astype(np.int32)), "brain")


def _uniform(fine: pv.PolyData, n_points: int) -> pv.PolyData:
    with warnings.catch_warnings():
        # pyacvd 0.4 reads an attribute that PyVista renamed
        warnings.filterwarnings("ignore", category=pv.PyVistaDeprecationWarning)
        clusters = pyacvd.Clustering(fine)
        clusters.cluster(n_points)
        coarse: pv.PolyData = clusters.create_mesh()
    return coarse


def _brain_mask() -> tuple[BoolArray, FloatArray]:
    # nilearn takes seconds to import: only this function needs it
    from nilearn.datasets import load_mni152_brain_mask

    image = load_mni152_brain_mask(resolution=VOXEL_MM)
    return np.asarray(image.dataobj) > 0, image.affine


def outermost(surface: Surface, direction: FloatArray) -> FloatArray:
    """Return the point farthest from the centre within 5° of a direction."""
    from_centre = surface.points - surface.points.mean(axis=0)
    cosine = from_centre @ direction / np.linalg.norm(direction)
    cosine /= np.linalg.norm(from_centre, axis=1)
    point: FloatArray = surface.points[cosine.argmax()]
    return point


def sphere(centre: FloatArray, radius: float) -> Surface:
    """Return an icosphere of 162 points: edges of 3.3 mm at 11 mm radius."""
    ball = pv.Icosphere(radius=radius, center=centre, nsub=2)
    return Surface(ball.points, ball.regular_faces.astype(np.int32))

"""Synthetic patients: the bundled brain in other shapes, opened and ill elsewhere.

A network that is to serve a patient it never saw has to learn from many. Each here is
drawn at random: the brain stretched, sheared and bent, a tumour under a craniotomy in
another place, the skull holding what the craniotomy leaves, a mesh of another density.
"""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_surface
from physgnn.geometry.meshing.tetrahedra import tetrahedralize
from physgnn.geometry.point_sets import Sphere, select
from physgnn.geometry.surface import Surface
from physgnn.geometry.surfaces.checks import check_nested, check_surface
from physgnn.geometry.synthetic.phantom import mni152_phantom, outermost, sphere
from physgnn.geometry.tetmesh import TetMesh

N_BENDS = 5
STEEPEST = np.exp(-0.5)  # slope of a Gaussian of height and width 1
UPWARD = 0.2  # of a craniotomy's direction: there is none in the skull's base


@dataclass(frozen=True)
class Anatomy:
    """One synthetic patient; lengths in mm.

    Attributes
    ----------
    stretch : three floats
        Along x, y, z.
    shear : three floats
        Of x by y, x by z, y by z.
    bends_mm, bend_width_mm : float
        Length and width (standard deviation) of the Gaussian displacements that bend
        the brain.
    craniotomy : three floats
        Direction of its middle from the brain's centre.
    craniotomy_radius_mm : float
    tumour_radius_mm, tumour_depth_mm : float
        Its depth is the brain left between it and the cortex.
    tilt_deg : float
        Angle between the craniotomy's direction and the normal of the plane below
        which the skull holds the brain.
    held : float
        Fraction of the brain's surface points that the skull holds.
    surface_points, points : int
        About how many the brain's surface and the mesh have.
    seed : int
        Of bends and tilt.

    Raises
    ------
    InputError
        If the bends are so steep that they might fold the brain.
    """

    stretch: tuple[float, float, float]
    shear: tuple[float, float, float]
    bends_mm: float
    bend_width_mm: float
    craniotomy: tuple[float, float, float]
    craniotomy_radius_mm: float
    tumour_radius_mm: float
    tumour_depth_mm: float
    tilt_deg: float
    held: float
    surface_points: int
    points: int
    seed: int

    def __post_init__(self) -> None:
        slope = N_BENDS * STEEPEST * self.bends_mm / self.bend_width_mm
        if not slope < 1:
            raise InputError(
                f"bends of {self.bends_mm:g} mm over {self.bend_width_mm:g} mm may "
                f"fold the brain: their slopes add up to {slope:.2f}, keep it below 1"
            )


def draw_anatomy(seed: int) -> Anatomy:
    """Return a patient at random; the same seed gives the same one."""
    random = np.random.default_rng(seed)
    direction = random.normal(size=3)
    direction /= np.linalg.norm(direction)
    direction[2] = UPWARD + abs(direction[2])
    surface_points = int(random.integers(450, 900))
    return Anatomy(
        stretch=_three(random.uniform(0.88, 1.06, 3)),
        shear=_three(random.uniform(-0.08, 0.08, 3)),
        bends_mm=random.uniform(2.0, 8.0),
        bend_width_mm=random.uniform(30.0, 50.0),
        craniotomy=_three(direction / np.linalg.norm(direction)),
        craniotomy_radius_mm=random.uniform(35.0, 60.0),
        tumour_radius_mm=random.uniform(7.0, 15.0),
        tumour_depth_mm=random.uniform(5.0, 25.0),
        tilt_deg=random.uniform(0.0, 30.0),
        held=random.uniform(0.5, 0.75),
        surface_points=surface_points,
        points=int(random.uniform(5.0, 9.0) * surface_points),
        seed=seed,
    )


def build_anatomy(anatomy: Anatomy) -> TetMesh:
    """Mesh a patient.

    Returns
    -------
    TetMesh
        Region 0 brain, 1 tumour; point sets ``fixed``, what the skull holds, and
        ``loaded``, what the craniotomy lays open.

    Raises
    ------
    InputError
        If brain and tumour cannot be meshed: draw another.
    """
    random = np.random.default_rng(anatomy.seed)
    whole = mni152_phantom(n_points=anatomy.surface_points).brain
    changed = Surface(_changed(whole.points, anatomy, random), whole.faces)
    brain, _ = check_surface(changed, "brain")
    centre = brain.points.mean(axis=0)
    cortex = outermost(brain, np.array(anatomy.craniotomy))
    inward = (centre - cortex) / np.linalg.norm(centre - cortex)
    radius = anatomy.tumour_radius_mm
    within = cortex + (anatomy.tumour_depth_mm + radius) * inward
    tumour, _ = check_surface(sphere(within, radius), "tumour")
    check_nested(brain, [tumour])
    mesh = tetrahedralize(brain, [tumour], target_points=anatomy.points)
    normal = _tilted(-inward, anatomy.tilt_deg, random)
    return _held_and_opened(mesh, anatomy, cortex, normal)


def _changed(
    points: FloatArray, anatomy: Anatomy, random: np.random.Generator
) -> FloatArray:
    """Stretch, shear, then bend by Gaussian bumps about points of the brain."""
    matrix = np.diag(anatomy.stretch)
    matrix[[0, 0, 1], [1, 2, 2]] = anatomy.shear
    points = points @ matrix.T
    moved = points.copy()
    for middle in points[random.choice(len(points), N_BENDS, replace=False)]:
        way = random.normal(size=3)
        away = np.linalg.norm(points - middle, axis=1) / anatomy.bend_width_mm
        bump = anatomy.bends_mm * np.exp(-0.5 * away**2)
        moved += bump[:, None] * way / np.linalg.norm(way)
    return moved


def _held_and_opened(
    mesh: TetMesh, anatomy: Anatomy, cortex: FloatArray, normal: FloatArray
) -> TetMesh:
    surface = np.unique(boundary_surface(mesh).faces).astype(np.int64)
    height = mesh.points[surface] @ normal
    held = surface[height < np.quantile(height, anatomy.held)]
    opened = select(mesh, Sphere(tuple(cortex), anatomy.craniotomy_radius_mm))
    return mesh.with_point_sets(fixed=held, loaded=np.setdiff1d(opened, held))


def _tilted(
    direction: FloatArray, angle_deg: float, random: np.random.Generator
) -> FloatArray:
    """Return a direction turned by an angle towards anywhere."""
    side = np.cross(direction, random.normal(size=3))
    side /= np.linalg.norm(side)
    angle = np.deg2rad(angle_deg)
    turned: FloatArray = np.cos(angle) * direction + np.sin(angle) * side
    return turned


def _three(values: FloatArray) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return x, y, z

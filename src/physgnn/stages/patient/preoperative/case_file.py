"""What to simulate on a patient's mesh, written as a TOML file to begin with."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import KDTree

from physgnn.arrays import FloatArray
from physgnn.config import read_preset
from physgnn.dataset.membranes import NAMES as MEMBRANES
from physgnn.dataset.membranes import Membranes
from physgnn.errors import InputError
from physgnn.geometry import TetMesh, boundary_surface, contains, vertex_normals
from physgnn.geometry.normals import area_vectors
from physgnn.geometry.plausibility import UNITS
from physgnn.geometry.point_sets import HalfSpace, Nearest, select
from physgnn.geometry.regions import REGIONS, TUMOUR
from physgnn.geometry.surface import Surface
from physgnn.io import read_mesh
from physgnn.io.integrity.atomic import write_whole
from physgnn.io.medical.markups import read_points
from physgnn.mechanics.materials import TISSUES
from physgnn.progress import Log, no_log
from physgnn.stages.outputs import Output, writes

# The skull holds this part of the surface, as in the middle of the synthetic patients.
HELD = 0.6
FEWEST_LOADED = 10
# A point on the scalp or in the bone flap is this near to the cortex, mm.
LARGEST_DISTANCE = 40.0
# Inside, a mesh whose folds are smoothed away leaves this much, mm.
DEEPEST = 15.0
# A point in another unit lies near to where all coordinates are 0; in its own, here.
ON_CORTEX, SMALLEST_COORDINATE = 10.0, 1.0
# Half as strong as the loads of the published second set: on the published surfaces, by
# 9 to 21 mm at most. Cortical shifts of up to 24 mm were seen in 64 patients (Nimsky et
# al. 2000, Neurosurgery 47, 1070-1080).
TRACTION_PA = 1100.0
RADIUS_MM = (5.0, 100.0)


@dataclass(frozen=True)
class Craniotomy:
    """Where the skull is open.

    Attributes
    ----------
    centre_mm : (3,) array
        The point of the cortex in its middle.
    loaded : Nearest
        The points laid open.
    fixed : HalfSpace
        Those the skull holds.
    area_mm2 : float
        Of the surface laid open.
    """

    centre_mm: FloatArray
    loaded: Nearest
    fixed: HalfSpace
    area_mm2: float


@writes(out=Output((".toml",)))
def init(
    case: str | Path,
    out: str | Path,
    *,
    craniotomy: str | Path | None = None,
    radius_mm: float = 30.0,
    log: Log = no_log,
) -> Craniotomy:
    """Write a commented TOML file that `simulate` and `adapt` run as it is.

    Parameters
    ----------
    case : path
        The patient's mesh, VTU.
    out : path
        Where the file goes, TOML.
    craniotomy : path, optional
        One point over or on the cortex: markups of 3D Slicer (.mrk.json, .fcsv) or a
        CSV. By default the cortex nearest to the tumour.
    radius_mm : float
        Of what the craniotomy lays open, 5-100.
    log : callable
        Called with where the craniotomy is.

    Returns
    -------
    Craniotomy
        The rules that were written.

    Raises
    ------
    InputError
        If the mesh has no tumour and no point is given, the point is not at the head,
        or a file cannot be used.
    """
    if not RADIUS_MM[0] <= radius_mm <= RADIUS_MM[1]:
        raise InputError(f"radius_mm must be in 5…100 (got {radius_mm})")
    mesh = read_mesh(case, log=log)
    surface = boundary_surface(mesh)
    point = (
        _nearest_to_tumour(mesh, surface)
        if craniotomy is None
        else _cortex_at(_one_point(craniotomy, log), surface, str(craniotomy))
    )
    opened = craniotomy_at(surface, point, radius_mm)
    x, y, z = opened.centre_mm
    log(
        f"craniotomy at ({x:.1f}, {y:.1f}, {z:.1f}) mm: {opened.loaded.count} points "
        f"over {opened.area_mm2 / 100:.1f} cm² loaded, "
        f"{len(select(mesh, opened.fixed))} points held"
    )
    write_whole(Path(out), case_text(mesh, opened, Path(case).name, Path(out).name))
    read_preset(out)
    return opened


def craniotomy_at(surface: Surface, point: FloatArray, radius_mm: float) -> Craniotomy:
    """Return what a craniotomy about a point of a surface lays open, and the rest.

    Held is what lies deepest along the normal at the point, and nothing laid open.
    """
    used = np.unique(surface.faces)
    points = surface.points[used]
    distance = np.linalg.norm(points - point, axis=1)
    count = max(FEWEST_LOADED, int((distance <= radius_mm).sum()))
    loaded = Nearest(_three(point), min(count, len(used)))
    near = select(surface, loaded)
    normal = vertex_normals(surface)[near].mean(axis=0)
    normal /= np.linalg.norm(normal)
    # the rule's height is along (-cos a sin b, sin a, cos a cos b)
    a, b = np.arcsin(np.clip(normal[1], -1, 1)), np.arctan2(-normal[0], normal[2])
    angles = (round(float(np.degrees(a)), 2), round(float(np.degrees(b)), 2))
    rule = HalfSpace(angles, (0.0, 0.0, 0.0), "<", 0.0)
    height = rule.height(surface.points)
    limit = min(float(np.quantile(height[used], HELD)), float(height[near].min()))
    fixed = HalfSpace(angles, (0.0, 0.0, 0.0), "<", round(limit, 2))
    if not len(fixed.select(surface)):
        raise InputError(
            f"the craniotomy must leave a part of the surface to the skull "
            f"(its radius is {radius_mm:g} mm): make it smaller"
        )
    open_faces = np.isin(surface.faces, near).all(axis=1)
    areas = np.linalg.norm(area_vectors(surface.points, surface.faces), axis=1)
    return Craniotomy(point, loaded, fixed, float(areas[open_faces].sum()))


def case_text(mesh: TetMesh, opened: Craniotomy, case: str, name: str) -> str:
    """Return the file's text."""
    present = [REGIONS[i] for i in np.unique(mesh.region) if i < len(REGIONS)]
    materials = "\n".join(
        f'\n[materials.{region}]\ntissue = "{region}"  # {_described(region)}'
        for region in present
    )
    force = max(round(TRACTION_PA * opened.area_mm2 * 1e-6, 2), 0.01)
    square_cm = opened.area_mm2 / 100
    a, b = opened.fixed.rotation_deg
    return f"""\
# What to simulate on {case}: edit what you know better, then run
#   physgnn simulate {case} --loads {name} -o loads.zarr
#   physgnn adapt RUN {case} --loads {name} -o run/
# Lengths in mm, RAS+; every key is explained in the page "Loads".

element = "tet4"  # "tet4-averaged" where tissue is nearly incompressible

# What the skull holds: the {HELD:.0%} of the surface that lie deepest, seen from the
# craniotomy. The height is measured along the normal there.
[point_sets.fixed]
kind = "half_space"
rotation_deg = [{a}, {b}]
offset_mm = [0.0, 0.0, 0.0]
keep = "<"
limit_mm = {opened.fixed.limit_mm}

# What the craniotomy lays open: so many points nearest to its middle.
[point_sets.loaded]
kind = "nearest"
point_mm = {[round(float(x), 2) for x in opened.centre_mm]}
count = {opened.loaded.count}

# One table for each region of the mesh: a tissue by name ({", ".join(TISSUES)}),
# or a law and its parameters.
{materials.strip()}
{_membranes(mesh)}
# Forces on what is laid open, drawn at random about the inward normal. At the last
# level they are as strong as {TRACTION_PA:g} Pa over its {square_cm:.1f} cm².
[loads]
total_force_n = {force}
cone_deg = 30.0  # directions up to this angle about the normal
paths = 20
levels = 10
seed = 0

# Sag under gravity instead: uncomment this, and leave only levels in [loads].
# [[loads.more]]
# kind = "gravity"
# direction = [0, 0, -1]
"""


def _membranes(mesh: TetMesh) -> str:
    """Return the table of the sheets that the mesh has points of, or nothing."""
    there = [name for name in MEMBRANES if name in mesh.point_sets]
    if not there:
        return ""
    sheets = Membranes()
    left_out = "\n".join(f'{name} = "{getattr(sheets, name)}"' for name in there)
    return f"""
# Stiff sheets of dura that the mesh has points of. What each does:
#   "left-out"  its points move with the brain
#   "elastic"   springs pull them back to where they rest; for simulate, not adapt
#   "held"      they cannot move, like those that the skull holds
[membranes]
{left_out}
stiffness_pa_per_mm = {sheets.stiffness_pa_per_mm:g}  # of elastic ones
"""


def _described(region: str) -> str:
    """Return the source of a tissue, as far as its first pause outside of brackets."""
    source = str(TISSUES[region].source).split(":", maxsplit=1)[0]
    whole = re.match(r"(?:\([^)]*\)|[^,(])*", source)
    return source if whole is None else whole[0].strip()


def _three(point: FloatArray) -> tuple[float, float, float]:
    x, y, z = (round(float(value), 2) for value in point)
    return x, y, z


def _one_point(path: str | Path, log: Log) -> FloatArray:
    points = read_points(path, log=log)
    if len(points) != 1:
        raise InputError(
            f"{path}: the craniotomy must be one point (these are {len(points)}): "
            "keep the one in its middle"
        )
    return np.asarray(points[0], dtype=np.float64)


def _cortex_at(point: FloatArray, surface: Surface, name: str) -> FloatArray:
    """Return the surface's point nearest to one over or on it."""
    used = surface.points[np.unique(surface.faces)]
    tree = KDTree(used)
    distance, nearest = tree.query(point)
    inside = contains(surface, point)
    farthest = DEEPEST if inside else LARGEST_DISTANCE
    unit = _unit(point, tree, float(distance))
    if distance <= farthest and not unit:
        return np.asarray(used[nearest])
    where = "inside the brain" if inside else "outside of the head"
    turned, _ = tree.query(point * [-1.0, -1.0, 1.0])
    hint = "place it on the scan that the mesh was made from"
    if unit:
        hint = f"it looks like {unit}, so multiply it by {UNITS[unit]:g}"
    elif turned <= LARGEST_DISTANCE and not inside:
        hint = "its x and y look like LPS, so turn their signs"
    x, y, z = point
    low, high = used.min(axis=0).round(0), used.max(axis=0).round(0)
    raise InputError(
        f"{name}: the craniotomy must lie at the cortex (the point ({x:.1f}, {y:.1f}, "
        f"{z:.1f}) mm is {where}, {distance:.0f} mm from the surface, which spans "
        f"{low} to {high} mm): {hint}"
    )


def _unit(point: FloatArray, tree: KDTree, distance: float) -> str:
    """Return the unit in which a point lies on the cortex, if in mm it does not."""
    if distance <= ON_CORTEX and np.abs(point).max() >= SMALLEST_COORDINATE:
        return ""
    for unit, mm in UNITS.items():
        place = point * mm  # what shrinks to a point fits anywhere
        if np.abs(place).max() >= SMALLEST_COORDINATE:
            away, _ = tree.query(place)
            if away <= ON_CORTEX:
                return unit
    return ""


def _nearest_to_tumour(mesh: TetMesh, surface: Surface) -> FloatArray:
    cells = mesh.cells[mesh.region == TUMOUR]
    if not len(cells):
        raise InputError(
            "the mesh has no tumour to place the craniotomy over: give its point "
            "(--craniotomy point.mrk.json)"
        )
    used = surface.points[np.unique(surface.faces)]
    distance, _ = KDTree(mesh.points[np.unique(cells)]).query(used)
    return np.asarray(used[distance.argmin()])

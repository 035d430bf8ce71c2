"""The brain that is registered, and every method's displacement of the true one."""

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property

import numpy as np
import pyvista as pv

from physgnn.arrays import FloatArray
from physgnn.evaluation.in_silico.cases import EXPOSED_MM
from physgnn.evaluation.in_silico.peers import (
    nearest_pairs,
    rigid,
    rigid_icp,
    spline,
)
from physgnn.evaluation.in_silico.shifts import held
from physgnn.geometry import (
    Surface,
    TetMesh,
    boundary_surface,
    mni152_phantom,
    tetrahedralize,
)
from physgnn.geometry.measured import PointPairs, SurfacePoints
from physgnn.mechanics import NeoHookean
from physgnn.mechanics.body import Body
from physgnn.registration.measurements.surfaces import N_SURFACE_POINTS
from physgnn.registration.registrar import Registrar
from physgnn.registration.removed_region import resected

N_SKULL = 60  # points of the skull that a spline is told of
HELD_MM, TOLD_MM = 75.0, 0.75
MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
SURFACE_POINTS = 600

ShiftMeasured = PointPairs | SurfacePoints
AllMeasured = ShiftMeasured | Sequence[ShiftMeasured]


def every(measured: AllMeasured) -> tuple[ShiftMeasured, ...]:
    """Return what was measured one by one."""
    if isinstance(measured, PointPairs | SurfacePoints):
        return (measured,)
    return tuple(measured)


class Compared:
    """The mesh that is registered, and what else it may be compared with.

    Parameters
    ----------
    n_points : int
        About how many the mesh has.
    skull : str
        A row of `physgnn.registration.skull.SUPPORTS`.
    x : (n, 3) array
        Where displacements are wanted: the true body's points, mm.
    causes : sequence of str, optional
        As `physgnn.registration.registrar.Registrar` has them.
    surface_points : int
        About how many the brain's surface has.
    removed : str, optional
        A region that was resected; what is left is registered, as
        ``physgnn register --remove`` does.
    tumours : sequence of Surface, optional
        As they were segmented; by default those of this coarser brain, whose
        craniotomy and tumour lie some millimetres beside the true ones.
    """

    def __init__(
        self,
        n_points: int,
        skull: str,
        x: FloatArray,
        causes: Sequence[str] | None = (),
        *,
        surface_points: int = SURFACE_POINTS,
        removed: str | None = None,
        tumours: Sequence[Surface] | None = None,
    ) -> None:
        phantom = mni152_phantom(n_points=surface_points)
        inside = phantom.tumours if tumours is None else tumours
        mesh = tetrahedralize(phantom.brain, inside, target_points=n_points)
        whole = held(mesh, phantom, HELD_MM)
        self.mesh = whole if removed is None else resected(whole, removed).remaining
        self.craniotomy_point = phantom.craniotomy_point
        self.body = Body(self.mesh, MATERIALS)
        self.x = x
        self._skull, self._causes = skull, causes
        self._locate = _sampler(self.mesh, x)
        chosen = np.random.default_rng(0).choice(whole.point_set("fixed"), N_SKULL)
        self.anchors = whole.points[chosen]
        outer = boundary_surface(mesh)
        middles = outer.points[outer.faces].mean(axis=1)
        exposed = np.concatenate([mesh.points[np.unique(outer.faces)], middles])
        offset = np.linalg.norm(exposed - phantom.craniotomy_point, axis=1)
        self.exposed = exposed[offset < EXPOSED_MM]

    @cached_property
    def registrar(self) -> Registrar:
        """What registers the mesh; made when it is first wanted."""
        return Registrar(self.body, skull=self._skull, causes=self._causes)

    def at_truth(self, displacement: FloatArray) -> FloatArray:
        """Return a displacement of the registered mesh at the true points."""
        return self._locate(displacement)

    def pairs(self, measured: AllMeasured) -> PointPairs:
        """Return all pairs; if there are none, those nearest to a surface at rest."""
        found = every(measured)
        given = [one for one in found if isinstance(one, PointPairs)]
        if not given:
            surfaces = [one for one in found if isinstance(one, SurfacePoints)]
            given = [
                nearest_pairs(one.thinned(N_SURFACE_POINTS), self.exposed)
                for one in surfaces
            ]
        source = np.concatenate([one.source for one in given])
        return PointPairs(source, np.concatenate([one.target for one in given]))


def zero(body: Compared, measured: AllMeasured) -> FloatArray:
    """Nothing moves."""
    del measured
    return np.zeros_like(body.x)


def rigid_motion(body: Compared, measured: AllMeasured) -> FloatArray:
    """All moves as one; of a surface alone by iterated matching."""
    found = every(measured)
    if len(found) == 1 and isinstance(found[0], SurfacePoints):
        return rigid_icp(found[0].thinned(N_SURFACE_POINTS), body.exposed, body.x)
    return rigid(body.pairs(found), body.x)


def skull_spline(body: Compared, measured: AllMeasured) -> FloatArray:
    """Interpolate by a thin-plate spline; sixty points of the skull stay."""
    return spline(body.pairs(measured), body.x, body.anchors)


def linear_elasticity(body: Compared, measured: AllMeasured) -> FloatArray:
    """Take the first step of our registration, linear elasticity."""
    found = body.registrar(measured, noise_mm=TOLD_MM, linear=True)
    return body.at_truth(found.prediction.displacement)


def registration(body: Compared, measured: AllMeasured) -> FloatArray:
    """Register as ``physgnn register`` does."""
    found = body.registrar(measured, noise_mm=TOLD_MM)
    return body.at_truth(found.prediction.displacement)


ShiftMethod = Callable[[Compared, AllMeasured], FloatArray]
SHIFT_METHODS: Mapping[str, ShiftMethod] = {
    "zero": zero,
    "rigid": rigid_motion,
    "spline": skull_spline,
    "linear": linear_elasticity,
    "register": registration,
}
"""From the body that is registered and what was measured to the displacement of the
true points, (n, 3), mm."""


def _sampler(mesh: TetMesh, x: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return a function that interpolates fields of a mesh at points.

    A point just outside takes the value of the nearest place of the nearest cell.
    """
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
    corners = mesh.cells[grid.find_closest_cell(x)]
    first, edges = mesh.points[corners[:, 0]], mesh.points[corners[:, 1:]]
    edges = np.moveaxis(edges - first[:, None], 1, 2)
    others = np.linalg.solve(edges, (x - first)[..., None])[..., 0]
    weights = np.column_stack([1.0 - others.sum(axis=1), others]).clip(0.0)
    weights /= weights.sum(axis=1, keepdims=True)
    return lambda u: np.einsum("ni,nij->nj", weights, u[corners])

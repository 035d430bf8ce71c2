"""How the skull holds the points of a set: fast, or free to slide along it.

A sliding point keeps to the plane that touches the brain there at rest: it neither
leaves the skull nor enters it. Two springs a point say so, each with the stiffness of
the point's share of surface under a layer of sheared tissue, μ/t: one of 0.01 mm across
the skull, which gives by a hundredth of a millimetre under a kilopascal, and one of
30 mm along it, for what tethers a brain (veins, nerves, falx) and keeps it from
spinning. Having slid by s, a point is off a skull of radius R by s²/2R: 0.2 mm for a
slide of 5 mm.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.choices import MembraneSupport
from physgnn.dataset.membranes import Membranes
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces, boundary_surface
from physgnn.geometry.normals import area_vectors, vertex_normals
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import Pattern
from physgnn.mechanics.loads.springs import membrane_springs

ACROSS_MM, ALONG_MM = 0.01, 30.0


@dataclass(frozen=True, eq=False)
class Support:
    """Which points are held, and how.

    Attributes
    ----------
    held : (n_held,) integer array
        Points that do not move.
    sprung : (n_sprung,) integer array
        Points on springs.
    stiffness : (n_sprung, 3, 3) array
        Of each spring, symmetric, N/mm.
    """

    held: IntArray
    sprung: IntArray
    stiffness: FloatArray

    def add_force(self, displacement: FloatArray, force: FloatArray) -> None:
        """Add what the springs hold back to an internal force (n_points, 3), N."""
        pulled = displacement[self.sprung]
        force[self.sprung] += np.einsum("nij,nj->ni", self.stiffness, pulled)

    def add_tangent(self, pattern: Pattern, data: FloatArray) -> None:
        """Add the springs to the tangent's values in the pattern's order, N/mm."""
        row = 3 * pattern.row[self.sprung]
        for i in range(3):
            for j in range(i, 3):
                # the diagonal block comes first in each of its rows
                data[pattern.indptr[row + i] + j - i] += self.stiffness[:, i, j]


def fixed_support(body: Body) -> Support:
    """Hold the fixed points where they are."""
    return Support(body.fixed, np.empty(0, dtype=np.int64), np.empty((0, 3, 3)))


def sliding_support(body: Body, *, along_mm: float = ALONG_MM) -> Support:
    """Let the fixed points slide along the brain's surface.

    Parameters
    ----------
    body : Body
        Its fixed points are on the outer surface; the mean shear modulus of its
        materials scales the springs.
    along_mm : float
        Thickness of the layer whose shear stiffness resists sliding, mm.

    Raises
    ------
    InputError
        If a point is not on the outer surface.
    """
    mesh, points = body.mesh, body.fixed
    normals = vertex_normals(boundary_surface(mesh))[points]
    if not normals.any(axis=1).all():
        raise InputError(
            "points that slide along the skull must lie on the outer surface (one of "
            "the point set does not): choose it by a rule of "
            "docs/reference/point_sets.md"
        )
    moduli = [body.materials[int(label)].mu for label in mesh.region]
    mu = float(np.average(moduli, weights=mesh.cell_volumes))
    across = normals[:, :, None] * normals[:, None, :]
    springs = across / ACROSS_MM + (np.eye(3) - across) / along_mm
    share = mu * point_areas(mesh)[points]
    return Support(np.empty(0, dtype=np.int64), points, share[:, None, None] * springs)


def with_membranes(support: Support, body: Body, membranes: Membranes) -> Support:
    """Return a support to which falx and tentorium belong, held or on springs.

    Parameters
    ----------
    support : Support
        Of the points at the skull; these keep it where they are of a sheet too.
    body : Body
        Its mesh has the point sets of the membranes that are not left out.
    membranes : Membranes
        How they act.

    Raises
    ------
    InputError
        If the mesh lacks a membrane that is not left out.
    """
    mesh = body.mesh
    membranes.check_against(mesh)
    held = membranes.points(mesh, MembraneSupport.HELD, body.fixed)
    besides = np.union1d(body.fixed, held)
    elastic = membranes.points(mesh, MembraneSupport.ELASTIC, besides)
    found = Support(
        np.union1d(support.held, held).astype(np.int64),
        support.sprung,
        support.stiffness,
    )
    if not len(elastic):
        return found
    springs = membrane_springs(mesh, elastic, membranes.stiffness_pa_per_mm)
    each = springs.stiffness_n_per_mm[:, None, None] * np.eye(3)
    return Support(
        found.held,
        np.concatenate([found.sprung, springs.nodes]),
        np.concatenate([found.stiffness, each]),
    )


def point_areas(mesh: TetMesh) -> FloatArray:
    """Return every point's share of the outer surface, mm², shape (n_points,)."""
    area = np.zeros(mesh.n_points)
    faces = boundary_faces(mesh)
    size = np.linalg.norm(area_vectors(mesh.points, faces), axis=1)
    np.add.at(area, faces, size[:, None] / 3)
    return area


SUPPORTS: Mapping[str, Callable[[Body], Support]] = {
    "fixed": fixed_support,
    "sliding": sliding_support,
}

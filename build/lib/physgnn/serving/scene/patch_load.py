"""From a touch on the exposed surface to nodal forces."""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry import boundary_points, boundary_surface, vertex_normals
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.patch_sampling import patch_load_fractions
from physgnn.mechanics.loads.paths import LoadCase

TOUCH_MM = 10.0  # a point farther from every exposed node is not on the surface


@dataclass(frozen=True, eq=False)
class Exposed:
    """The surface that can be touched.

    Attributes
    ----------
    nodes : (n,) integer array
        Its nodes, ascending.
    points, normals : (n, 3) arrays
        Where they are, mm, and their outward unit normals.
    """

    nodes: IntArray
    points: FloatArray
    normals: FloatArray

    @classmethod
    def of(cls, body: Body, nodes: IntArray | None = None) -> "Exposed":
        """Return these nodes as far as they can be loaded; by default the free surface.

        Raises
        ------
        InputError
            If none is on the surface and free.
        """
        free = np.setdiff1d(boundary_points(body.mesh), body.fixed)
        exposed = free if nodes is None else np.intersect1d(free, nodes)
        if len(exposed) == 0:
            raise InputError(
                "no node can be loaded: every point of the exposed surface is fixed"
            )
        normals = vertex_normals(boundary_surface(body.mesh))[exposed]
        return cls(exposed, body.mesh.points[exposed], normals)


def spread_force(
    exposed: Exposed, point: FloatArray, force_n: FloatArray, radius_mm: float
) -> LoadCase:
    """Spread a force over the exposed nodes around a point.

    The weights are those of `physgnn.mechanics.loads.patch_sampling`; they add up to
    `force_n`. Where no node lies within the radius, the nearest carries it all.

    Parameters
    ----------
    exposed : Exposed
        What can be touched.
    point : (3,) array
        Centre of the patch at rest, mm.
    force_n : (3,) array
        The whole force, N.
    radius_mm : float
        Distance along the chord, mm.

    Raises
    ------
    InputError
        If the point is not on the exposed surface.
    """
    distance = np.linalg.norm(exposed.points - point, axis=1)
    nearest = int(distance.argmin())
    if distance[nearest] > max(TOUCH_MM, radius_mm):
        raise InputError(
            f"point must lie on the exposed surface (it is {distance[nearest]:.0f} mm "
            "away)"
        )
    weight = patch_load_fractions(distance / radius_mm, exposed.normals, nearest)
    loaded = np.flatnonzero(weight)
    return LoadCase(exposed.nodes[loaded], weight[loaded, None] * np.asarray(force_n))

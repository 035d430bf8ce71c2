"""From a touch on the exposed surface to nodal forces."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physgnn.errors import InputError
from physgnn.geometry import boundary_points, boundary_surface, vertex_normals
from physgnn.learning.interface import Body
from physgnn.mechanics.loads import LoadCase

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

PLATEAU = 0.5  # of the radius; a real instrument presses evenly up to near its rim
REACH_MM = 10.0  # a touch farther from every exposed node than this is none


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
        """Return these nodes as far as they can be pushed; by default the free surface.

        Raises
        ------
        InputError
            If none is on the surface and free.
        """
        free = np.setdiff1d(boundary_points(body.mesh), body.fixed)
        kept = free if nodes is None else np.intersect1d(free, nodes)
        if len(kept) == 0:
            raise InputError(
                "no node can be pushed: every point of the exposed surface is fixed"
            )
        normals = vertex_normals(boundary_surface(body.mesh))[kept]
        return cls(kept, body.mesh.points[kept], normals)


def push(
    exposed: Exposed, point: FloatArray, force_n: FloatArray, radius_mm: float
) -> LoadCase:
    """Spread a force over the exposed nodes around a point.

    The weight of a node is 1 up to half the radius and falls to 0 at the radius as a
    cosine; weights are divided by their sum, so the nodal forces add up to `force_n`.
    Where no node lies within the radius the nearest one takes all.

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
    if distance[nearest] > max(REACH_MM, radius_mm):
        raise InputError(
            f"point must lie on the exposed surface (it is {distance[nearest]:.0f} mm "
            "away)"
        )
    weight = _weight(distance / radius_mm)
    # The other side of a cleft is near, but no instrument touches both.
    weight[exposed.normals @ exposed.normals[nearest] <= 0] = 0.0
    if not weight.any():
        weight[nearest] = 1.0
    loaded = np.flatnonzero(weight)
    share = weight[loaded] / weight[loaded].sum()
    return LoadCase(exposed.nodes[loaded], share[:, None] * np.asarray(force_n))


def _weight(s: FloatArray) -> FloatArray:
    falling = np.clip((s - PLATEAU) / (1 - PLATEAU), 0.0, 1.0)
    weight: FloatArray = 0.5 * (1.0 + np.cos(np.pi * falling))
    weight[s >= 1] = 0.0
    return weight

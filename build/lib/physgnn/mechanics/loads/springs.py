"""Springs from points to where they rest: what a membrane holds without fixing it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.array_checks import checked_indices, checked_numbers
from physgnn.geometry.tetmesh import TetMesh


@dataclass(frozen=True, eq=False)
class Springs:
    """A force −k u on points, at every load factor: part of the support.

    Parameters
    ----------
    nodes : (n,) integer array
        Points, each named once.
    stiffness_n_per_mm : (n,) array
        k of each, > 0.

    Raises
    ------
    InputError
        If shapes disagree, a node comes twice, or a stiffness is not positive.
    """

    nodes: IntArray
    stiffness_n_per_mm: FloatArray

    def __post_init__(self) -> None:
        nodes = checked_indices(self.nodes, None, "nodes")
        stiffness = checked_numbers(self.stiffness_n_per_mm, "stiffness_n_per_mm")
        if nodes.size == 0 or len(np.unique(nodes)) < len(nodes):
            raise InputError("springs need one point or more, each named once")
        if stiffness.shape != nodes.shape:
            raise InputError(
                f"stiffness_n_per_mm must have one number a node, {len(nodes)} (got "
                f"shape {stiffness.shape})"
            )
        if not (np.isfinite(stiffness) & (stiffness > 0)).all():
            raise InputError("stiffness_n_per_mm must be > 0 and finite")
        object.__setattr__(self, "nodes", nodes)
        object.__setattr__(self, "stiffness_n_per_mm", stiffness)

    def check_against(self, mesh: TetMesh) -> None:
        """Raise InputError if a point is missing from the mesh."""
        checked_indices(self.nodes, mesh.n_points, "nodes of springs")

    def bind(self, mesh: TetMesh) -> Callable[[FloatArray, float], FloatArray]:
        """Return the force on every point as a function of displacement and factor."""

        def force(u: FloatArray, _: float) -> FloatArray:
            total = np.zeros((mesh.n_points, 3))
            total[self.nodes] = -self.stiffness_n_per_mm[:, None] * u[self.nodes]
            return total

        return force


def membrane_springs(
    mesh: TetMesh, points: IntArray, stiffness_pa_per_mm: float
) -> Springs:
    """Return the springs of a sheet of points, as stiff as its area says.

    Parameters
    ----------
    mesh : TetMesh
        The body.
    points : integer array
        One layer of points along the sheet.
    stiffness_pa_per_mm : float
        Pressure for a displacement of 1 mm, > 0.

    Returns
    -------
    Springs
        A point stands for v^⅔ of the sheet, v a quarter of the volume of its cells:
        within a tenth the area of a point in an even sheet of triangles.

    Raises
    ------
    InputError
        If the stiffness is no number > 0.
    """
    if not 0.0 < stiffness_pa_per_mm < np.inf:
        raise InputError(f"stiffness_pa_per_mm must be > 0 (got {stiffness_pa_per_mm})")
    own = np.bincount(
        mesh.cells.ravel(), np.repeat(mesh.cell_volumes / 4.0, 4), mesh.n_points
    )
    pa_mm2_to_n = 1e-6
    area = np.asarray(own[points] ** (2.0 / 3.0), dtype=np.float64)
    return Springs(points, stiffness_pa_per_mm * pa_mm2_to_n * area)

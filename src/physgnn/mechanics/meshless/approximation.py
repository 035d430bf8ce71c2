"""Everything of a meshless body that depends on its points and cells alone."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import scipy.sparse as sp

from physgnn.arrays import FloatArray
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.meshless.integration import (
    IntegrationPoints,
    integration_places,
)
from physgnn.mechanics.meshless.moving_least_squares import shape_functions
from physgnn.mechanics.meshless.options import MeshlessOptions
from physgnn.mechanics.meshless.supports import (
    Neighbours,
    neighbours,
    spacing,
    support_radii,
)

Pair: TypeAlias = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class Approximation:
    """Shape functions where they are needed.

    Attributes
    ----------
    integration : IntegrationPoints
        Their gradients at the integration points.
    shape : (n_points, n_points) sparse matrix
        φ_j at every point of the mesh, a row each: it turns nodal parameters into
        displacement, and its transpose turns forces on points into forces on
        parameters.
    """

    integration: IntegrationPoints
    shape: sp.csr_matrix


def make_approximation(mesh: TetMesh, options: MeshlessOptions) -> Approximation:
    """Evaluate the shape functions of a mesh's points.

    Raises
    ------
    InputError
        If the points around some place lie in one plane.
    """
    points, at_points = mesh.points, options.dilation * spacing(mesh)
    places = integration_places(mesh, options.points_per_cell)
    inside = np.repeat(at_points[mesh.cells].mean(axis=1), options.points_per_cell)

    def evaluate(x: FloatArray, wanted: FloatArray) -> tuple[Neighbours, Pair]:
        least = options.least_neighbours
        radii = support_radii(points, x, wanted=wanted, least=least)
        near = neighbours(points, radii, x)
        return near, shape_functions(points, radii, x, near)

    near, (_, gradients) = evaluate(places, inside)
    around, (values, _) = evaluate(points, at_points)
    shape = sp.csr_matrix((values, around.nodes, around.start), (len(points),) * 2)
    per_cell = options.points_per_cell
    return Approximation(
        IntegrationPoints(near.start, near.nodes, gradients, per_cell), shape
    )

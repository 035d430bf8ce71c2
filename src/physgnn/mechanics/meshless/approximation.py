"""Everything of a meshless body that depends on its points and cells alone."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.meshless.integration import (
    IntegrationPoints,
    integration_places,
)
from physgnn.mechanics.meshless.moving_least_squares import shape_functions
from physgnn.mechanics.meshless.options import MeshlessOptions
from physgnn.mechanics.meshless.supports import neighbours, support_radii


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
    points = mesh.points
    places = integration_places(mesh, options.points_per_cell)
    radii = support_radii(
        mesh,
        np.concatenate([places, points]),
        dilation=options.dilation,
        least=options.least_neighbours,
    )
    near = neighbours(points, radii, places)
    _, gradients = shape_functions(points, radii, places, near)
    around = neighbours(points, radii, points)
    values, _ = shape_functions(points, radii, points, around)
    shape = sp.csr_matrix((values, around.nodes, around.start), (len(points),) * 2)
    per_cell = options.points_per_cell
    return Approximation(
        IntegrationPoints(near.start, near.nodes, gradients, per_cell), shape
    )

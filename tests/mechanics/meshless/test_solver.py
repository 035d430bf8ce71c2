"""Load paths without elements: known solutions, held points, and failures that say so.

Where a known solution is affine, the approximation holds it exactly and only the
integration of forces does not: 4 points a cell are good to a hundredth of the largest
displacement on these coarse blocks, and a single point is worse.
"""

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.equilibrium.solver import Solver
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.growth import VolumeGrowth
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.loads.sampling import equal_levels
from physgnn.mechanics.loads.springs import Springs
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.materials.homogeneous import free_width
from physgnn.mechanics.meshless.options import MeshlessOptions
from physgnn.mechanics.meshless.solver import MeshlessSolver

SOFT = NeoHookean(3000.0, 0.3)
NEARLY_INCOMPRESSIBLE = NeoHookean(3000.0, 0.49)
SIDE = 10.0
TIGHT = MeshlessOptions(tolerance_mm=1e-5, force_tolerance=1e-5)


def body_of(mesh: TetMesh, law: NeoHookean = SOFT) -> Body:
    return Body(mesh, {0: law, 1: law})


def moved(mesh: TetMesh, law: NeoHookean, A: np.ndarray, which: np.ndarray) -> Solution:
    """Displace some points affinely, and no others."""
    u = mesh.points @ A.T
    still = np.flatnonzero(which & ~u.any(axis=1))
    rest = np.flatnonzero(which & u.any(axis=1))
    path = LoadPath.of(equal_levels(2), PrescribedDisplacement(rest, u[rest]))
    body = Body(mesh, {0: law, 1: law}, still)
    return MeshlessSolver(body, options=TIGHT).solve(path)


@pytest.mark.parametrize(("points_per_cell", "bound"), [(4, 0.012), (1, 0.05)])
def test_patch(block: TetMesh, points_per_cell: int, bound: float) -> None:
    A = 0.3 * np.array([[0.05, 0.03, 0], [0, -0.04, 0.02], [0.01, 0, 0.03]])
    outer = ((block.points == 0) | (block.points == SIDE)).any(axis=1)
    u = block.points @ A.T
    still = np.flatnonzero(~u.any(axis=1))
    nodes = np.setdiff1d(np.flatnonzero(outer), still)
    path = LoadPath.of(equal_levels(1), PrescribedDisplacement(nodes, u[nodes]))
    corner = block.with_point_sets(fixed=np.array([0]))
    options = MeshlessOptions(
        points_per_cell=points_per_cell, tolerance_mm=1e-5, force_tolerance=1e-4
    )
    found = MeshlessSolver(body_of(corner), options=options).solve(path)
    assert found.converged
    np.testing.assert_allclose(found.displacement[0][outer], u[outer], atol=1e-10)
    error = np.abs(found.displacement[0] - u)[~outer].max()
    assert error < bound * np.abs(u).max()


def sides(mesh: TetMesh, *axes: int) -> np.ndarray:
    """Points on the planes x = 0 and x = SIDE of some axes."""
    x = mesh.points[:, list(axes)]
    return ((x == 0) | (x == SIDE)).any(axis=1)

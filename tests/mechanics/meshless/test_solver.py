"""Load paths without elements: known solutions, held points, and failures that say so.

Where a known solution is affine, the approximation holds it exactly and only the
integration of forces does not: 4 points a cell are good to a few hundredths of the
largest displacement on these coarse blocks.
"""

import re

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.normals import area_vectors
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import make_elements
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.equilibrium.solver import Solver
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.growth import VolumeGrowth
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.loads.sampling import equal_levels
from physgnn.mechanics.loads.springs import Springs
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.materials.homogeneous import free_width, uniaxial_stress
from physgnn.mechanics.meshless.approximation import Approximation
from physgnn.mechanics.meshless.integrated_forces import strain_energy
from physgnn.mechanics.meshless.options import MeshlessOptions
from physgnn.mechanics.meshless.solver import MeshlessSolver

SOFT = NeoHookean(3000.0, 0.3)
NEARLY_INCOMPRESSIBLE = NeoHookean(3000.0, 0.49)
SIDE = 10.0
TIGHT = MeshlessOptions(tolerance_mm=1e-5, force_tolerance=1e-5)


def body_of(mesh: TetMesh, law: NeoHookean = SOFT) -> Body:
    return Body(mesh, {0: law, 1: law})


@pytest.mark.parametrize(("points_per_cell", "bound"), [(4, 0.025), (1, 0.045)])
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


def pulled(mesh: TetMesh, traction_mpa: float, *places: np.ndarray) -> LoadPath:
    """Dead traction along z on the top, and the bottom moved as told."""
    faces = boundary_faces(mesh)
    faces = faces[np.isin(faces, mesh.point_set("loaded")).all(axis=1)]
    area = np.linalg.norm(area_vectors(mesh.points, faces), axis=1)
    share = np.bincount(faces.ravel(), np.repeat(area / 3, 3), mesh.n_points)
    top = mesh.point_set("loaded")
    bottom = np.setdiff1d(mesh.point_set("fixed"), [0])
    loads = [PrescribedDisplacement(bottom, u[bottom]) for u in places]
    forces = share[top, None] * [0.0, 0.0, traction_mpa]
    return LoadPath(top, forces, equal_levels(1), tuple(loads))


def test_uniaxial_stretch_near_incompressibility() -> None:
    stretch, law = 0.9, NEARLY_INCOMPRESSIBLE
    (width,) = free_width(law, np.array([stretch]))
    (stress_pa,) = uniaxial_stress(law, np.array([stretch]))
    whole = []
    for n in (4, 6):
        mesh = block_mesh(n, jitter=0.15)
        exact = mesh.points * (np.array([width, width, stretch]) - 1)
        body = body_of(mesh.with_point_sets(fixed=np.array([0])), law)
        found = MeshlessSolver(body).solve(pulled(mesh, 1e-6 * stress_pa, exact))
        assert found.converged, found.message
        error = found.displacement[0] - exact
        whole.append(np.linalg.norm(error) / np.linalg.norm(exact))
        # Edges are too soft on blocks so coarse; faces and the inside are right.
        n_planes = ((mesh.points == 0) | (mesh.points == SIDE)).sum(axis=1)
        rms = np.sqrt((error[n_planes < 2] ** 2).sum(axis=1).mean())
        assert rms < 0.04 * np.abs(exact).max()
    assert whole[1] < 0.6 * whole[0] < 0.1


def test_free_growth_is_stress_free(block: TetMesh) -> None:
    exact = block.points * (1.2 ** (1 / 3) - 1)
    bottom = np.setdiff1d(block.point_set("fixed"), [0])
    path = LoadPath.of(
        equal_levels(1),
        VolumeGrowth(np.arange(block.n_cells), 1.2),
        PrescribedDisplacement(bottom, exact[bottom]),
    )
    body = body_of(block.with_point_sets(fixed=np.array([0])))
    found = MeshlessSolver(body, options=TIGHT).solve(path)
    np.testing.assert_allclose(found.displacement[0], exact, atol=1e-4)


def test_nearer_to_a_refined_mesh_than_tetrahedra_are() -> None:
    coarse, fine = block_mesh(4, jitter=0.15), block_mesh(12)
    load = Gravity((0.8, 0.0, -0.6), 5e3)
    path = LoadPath.of(equal_levels(1), load)
    (truth,) = Solver(body_of(fine)).solve(path).displacement
    (tetrahedra,) = Solver(body_of(coarse)).solve(path).displacement
    (meshless,) = MeshlessSolver(body_of(coarse)).solve(path).displacement
    top = coarse.point_set("loaded")  # no jitter on the surface
    _, same = cKDTree(fine.points).query(coarse.points[top])
    truth = truth[same]

    def error(u: np.ndarray) -> float:
        return float(np.linalg.norm(u[top] - truth) / np.linalg.norm(truth))

    assert error(meshless) < min(0.1, error(tetrahedra) / 2)


@pytest.fixture(scope="module")
def pushed(block: TetMesh) -> Solution:
    return MeshlessSolver(body_of(block)).solve(push(block, 4e-3))


def push(mesh: TetMesh, force_n: float) -> LoadPath:
    point = mesh.point_set("loaded")[[5]]
    return LoadPath(point, [[0.0, force_n / 4, -force_n]], equal_levels(2))


def test_points_are_held(block: TetMesh, pushed: Solution) -> None:
    assert pushed.converged
    assert pushed.counts["time_steps"] > 0
    assert (pushed.residual <= MeshlessOptions().force_tolerance).all()
    assert np.abs(pushed.displacement).max() > 0.1
    held = pushed.displacement[:, block.point_set("fixed")]
    np.testing.assert_allclose(held, 0, atol=1e-10)


def test_at_rest_energy_is_least(
    block: TetMesh, approximation: Approximation, pushed: Solution
) -> None:
    elements, path = make_elements(block, {0: SOFT, 1: SOFT}), push(block, 4e-3)

    def potential(u: np.ndarray) -> float:
        parameters = spsolve(approximation.shape.tocsc(), u)
        stored = strain_energy(approximation.integration, elements, parameters)
        return stored - float((u[path.nodes] * path.forces).sum())

    u = pushed.displacement[-1]
    assert potential(u) < potential(pushed.displacement[0]) < potential(0 * u) == 0.0
    rng = np.random.default_rng(0)
    for _ in range(5):
        v = 0.02 * rng.uniform(-1, 1, u.shape)
        v[block.point_set("fixed")] = 0.0
        assert potential(u + v) > potential(u)


def test_the_tolerance_bounds_the_way_left(block: TetMesh, pushed: Solution) -> None:
    tight = MeshlessSolver(body_of(block), options=TIGHT).solve(push(block, 4e-3))
    left = np.linalg.norm(pushed.displacement - tight.displacement, axis=2).max()
    assert left < 1.5 * MeshlessOptions().tolerance_mm


def test_stiff_springs_hold_what_they_hold(block: TetMesh) -> None:
    top = block.point_set("loaded")
    path = LoadPath.of(
        equal_levels(1), Springs(top, np.full(len(top), 2.0)), Gravity((0, 0, -1), 3e4)
    )
    found = MeshlessSolver(body_of(block)).solve(path)
    assert found.converged, found.message
    assert np.abs(found.displacement).max() > 1.0
    assert np.abs(found.displacement[0, top]).max() < 0.01


def test_a_force_too_great_ends_the_path(block: TetMesh) -> None:
    found = MeshlessSolver(body_of(block)).solve(push(block, 1.0))
    assert found.status.tolist() == [Status.INVERTED, Status.NOT_REACHED]
    assert 0 < found.reached < 0.5
    assert re.match(
        r"stopped at load factor 0\.\d+: an element inverted.*\(cell \d+\)",
        found.message,
    )
    assert not found.displacement.any()


def test_too_few_steps_say_so(block: TetMesh) -> None:
    impatient = MeshlessOptions(max_iterations=60)
    found = MeshlessSolver(body_of(block), options=impatient).solve(push(block, 4e-3))
    assert found.status.tolist() == [Status.ITERATION_LIMIT, Status.NOT_REACHED]
    assert found.message == (
        "stopped at load factor 0.0000: the iteration cap was met: raise max_iterations"
    )
    assert np.isnan(found.residual).all()


def test_a_body_that_floats_is_refused(block: TetMesh) -> None:
    free = body_of(block.with_point_sets(fixed=np.array([0, 1])))
    with pytest.raises(InputError, match="at least three points must be fixed"):
        MeshlessSolver(free).solve(push(block, 1e-3))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"points_per_cell": 2}, "points_per_cell must be 1 or 4"),
        ({"dilation": 0.1}, "dilation must be in"),
        ({"least_neighbours": 4}, "least_neighbours must be ≥ 10"),
        ({"tolerance_mm": 0.0}, "tolerance_mm must be > 0"),
        ({"force_tolerance": float("nan")}, "force_tolerance must be > 0"),
        ({"max_iterations": 0}, "max_iterations must be ≥ 1"),
        ({"min_step": 1.0}, r"min_step must be in \(0, 1\)"),
    ],
)
def test_options_out_of_range(wrong: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        MeshlessOptions(**wrong)

"""Membranes in the support: held, elastic, left out."""

from functools import partial

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.dataset import Preset
from physgnn.dataset.membranes import Membranes
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import Body, NeoHookean, SolverOptions, Springs, solve
from physgnn.mechanics.equilibrium.full_newton import Newton
from physgnn.mechanics.loads.sampling import traction_paths
from physgnn.mechanics.loads.springs import membrane_springs

MATERIALS = {n: NeoHookean(3000.0, 0.4) for n in (0, 1)}
PATHS = partial(traction_paths, traction_pa=300.0, n_levels=2, n_paths=1)


@pytest.fixture
def mesh() -> TetMesh:
    body = block_mesh(4, side=40.0)
    middle = np.flatnonzero(body.points[:, 0] == 20.0)
    return body.with_point_sets(falx=middle)


def displaced(mesh: TetMesh, membranes: Membranes) -> np.ndarray:
    body, (path,) = Preset(MATERIALS, PATHS, membranes=membranes).on(mesh)
    found = solve(body, path, materials=MATERIALS, options=SolverOptions())
    return np.asarray(found.displacement[-1])


def test_an_elastic_membrane_lies_between_held_and_none(mesh: TetMesh) -> None:
    sheet = mesh.point_set("falx")
    free = displaced(mesh, Membranes())
    elastic = displaced(mesh, Membranes(falx="elastic"))
    stiff = displaced(mesh, Membranes(falx="elastic", stiffness_pa_per_mm=1e5))
    held = displaced(mesh, Membranes(falx="held"))
    moved = [np.linalg.norm(u[sheet], axis=1).mean() for u in (free, elastic, stiff)]
    assert moved[0] > moved[1] > moved[2] > 0.0
    assert (held[sheet] == 0.0).all()
    assert moved[2] < 0.1 * moved[0]


def test_springs_pull_back_in_proportion(mesh: TetMesh) -> None:
    springs = Springs(np.array([3, 5]), np.array([1.0, 2.0]))
    u = np.random.default_rng(0).normal(size=mesh.points.shape)
    force = springs.bind(mesh)(u, 0.3)
    np.testing.assert_allclose(force[[3, 5]], [-1.0 * u[3], -2.0 * u[5]])
    assert np.count_nonzero(force.any(axis=1)) == 2
    for nodes, k in (([1, 1], [1.0, 1.0]), ([1], [0.0]), ([1], [1.0, 2.0])):
        with pytest.raises(InputError):
            Springs(np.array(nodes), np.array(k))


def test_the_exact_solution_is_the_same(mesh: TetMesh) -> None:
    """Full Newton, which has the springs in its tangent, finds what `solve` finds."""
    membranes = Membranes(falx="elastic")
    body, (path,) = Preset(MATERIALS, PATHS, membranes=membranes).on(mesh)
    exact = Newton(Body(body, MATERIALS)).solve(path, np.zeros_like(body.points))
    assert exact is not None
    np.testing.assert_allclose(displaced(mesh, membranes), exact, atol=1e-3)
    pattern = Body(body, MATERIALS).pattern
    diagonal = pattern.indices[pattern.indptr[:-1]]
    np.testing.assert_array_equal(diagonal, np.arange(pattern.n_unknowns))


def test_the_stiffness_is_that_of_the_area(mesh: TetMesh) -> None:
    """An inner layer of a regular mesh, by area; at the rim cells are fewer."""
    points = mesh.points
    inner = (points[:, 0] == 20.0) & (points > 0).all(1) & (points < 40).all(1)
    springs = membrane_springs(mesh, np.flatnonzero(inner), 1000.0)
    area = springs.stiffness_n_per_mm / 1000.0 / 1e-6
    np.testing.assert_allclose(area, 100.0, rtol=0.01)


def test_what_the_mesh_lacks_is_said(mesh: TetMesh) -> None:
    preset = Preset(MATERIALS, PATHS, membranes=Membranes(tentorium="held"))
    with pytest.raises(InputError, match="no point set 'tentorium'"):
        preset.on(mesh)
    with pytest.raises(InputError, match="falx must be one of"):
        Membranes(falx="glued")
    with pytest.raises(InputError, match="stiffness_pa_per_mm"):
        Membranes(stiffness_pa_per_mm=0.0)


def test_held_points_carry_no_load(mesh: TetMesh) -> None:
    body, _ = Preset(MATERIALS, PATHS, membranes=Membranes(falx="held")).on(mesh)
    assert not np.intersect1d(body.point_set("fixed"), body.point_set("loaded")).size

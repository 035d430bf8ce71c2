"""A patch's dense system is that part of the body's sparse one."""

import numpy as np
import pytest
import scipy.sparse as sp

from physgnn.geometry.mesh_topology import points_within
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import MooneyRivlin, NeoHookean
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.patch import grow, newton_system
from physgnn.mechanics.elements.tangent import assemble_tangent
from physgnn.mechanics.elements.tet4 import energy_of, internal_force, strain_energy

SOFT, STIFF = NeoHookean(3000.0, 0.45), NeoHookean(7500.0, 0.45)
RUBBER = MooneyRivlin(c1_pa=400.0, c2_pa=100.0, bulk_modulus_pa=9000.0)


def patch_of(body: Body, centre: int, k_hops: int) -> tuple[np.ndarray, ...]:
    cells, n = body.elements.cells, body.mesh.n_points
    first = np.concatenate([[0], np.cumsum(np.bincount(cells.ravel(), minlength=n))])
    cells_of = np.argsort(cells.ravel(), kind="stable") // 4
    free = np.ones(n, dtype=bool)
    free[body.fixed] = False
    place = np.full(n, -1)
    points, touched = np.empty(n, dtype=int), np.empty(len(cells), dtype=int)
    seen = np.zeros(len(cells), dtype=bool)
    n_points, n_touched = grow(
        centre, k_hops, cells, first, cells_of, free, place, points, touched, seen
    )
    assert not seen.any()
    return points[:n_points], touched[:n_touched], place


@pytest.mark.parametrize("k_hops", [0, 1, 2])
def test_its_points_are_the_free_ones_within_so_many_edges(
    block: TetMesh, k_hops: int
) -> None:
    body = Body(block, {0: SOFT, 1: STIFF})
    centre = int(block.point_set("loaded")[5])
    points, touched, place = patch_of(body, centre, k_hops)
    within = np.flatnonzero(points_within(block, np.array([centre]), k_hops))
    assert set(points) == set(within) - set(body.fixed)
    np.testing.assert_array_equal(place[points], np.arange(len(points)))
    assert (place >= 0).sum() == len(points)
    touching = np.isin(block.cells, points).any(axis=1)
    assert sorted(touched) == np.flatnonzero(touching).tolist()


@pytest.mark.parametrize("law", [SOFT, RUBBER])
def test_its_system_is_that_part_of_the_bodys(
    block: TetMesh, law: NeoHookean | MooneyRivlin
) -> None:
    body = Body(block, {0: law, 1: STIFF})
    E, pattern = body.elements, body.pattern
    u = 0.02 * np.random.default_rng(0).standard_normal((block.n_points, 3))
    points, touched, place = patch_of(body, int(block.point_set("loaded")[5]), 2)
    n = 3 * len(points)
    K, force = np.zeros((n, n), dtype=np.float32), np.zeros(n)
    arrays = (E.cells, E.gradients, E.rest, E.volumes, E.law, E.constants)
    total = newton_system(touched, *arrays, u, place, K, force)
    values, _ = assemble_tangent(E, pattern, u)
    upper = sp.csr_array((values, pattern.indices, pattern.indptr))
    whole = (upper + sp.triu(upper, 1).T).toarray()
    dofs = (3 * pattern.row[points][:, None] + np.arange(3)).ravel()
    part = np.tril(whole[np.ix_(dofs, dofs)])
    np.testing.assert_allclose(np.tril(K), part, atol=1e-6 * np.abs(part).max())
    np.testing.assert_allclose(
        force, internal_force(E, u)[0][points].ravel(), atol=1e-12
    )
    assert total == pytest.approx(energy_of(touched, *arrays, u), rel=1e-12)
    every = np.arange(len(E.cells))
    assert energy_of(every, *arrays, u) == pytest.approx(strain_energy(E, u), rel=1e-12)


def test_an_inverted_cell_is_told(block: TetMesh) -> None:
    body = Body(block, {0: SOFT, 1: STIFF})
    E = body.elements
    centre = int(block.point_set("loaded")[5])
    points, touched, place = patch_of(body, centre, 1)
    u = np.zeros((block.n_points, 3))
    u[centre, 2] = -50.0
    K, force = np.zeros((3 * len(points),) * 2, np.float32), np.zeros(3 * len(points))
    arrays = (E.cells, E.gradients, E.rest, E.volumes, E.law, E.constants)
    assert newton_system(touched, *arrays, u, place, K, force) == np.inf
    assert energy_of(touched, *arrays, u) == np.inf

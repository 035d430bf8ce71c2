"""Averaged tetrahedra: an energy, its derivatives, and no locking."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from element_checks import check_forces_derive_from_energy, check_tangent, wobble
from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.averaged_pressure import make_averaging
from physgnn.mechanics.elements.tangent import assemble_tangent
from physgnn.mechanics.elements.tet4 import internal_force, make_elements, strain_energy
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.materials import TISSUES, MooneyRivlin, NeoHookean

MESH = block_mesh(2, jitter=0.15)
BODIES = [
    {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.499)},
    {0: TISSUES["brain-ogden"].material, 1: MooneyRivlin(300.0, 200.0, 2e4)},
]
ELEMENTS = [make_elements(MESH, body, "tet4-averaged") for body in BODIES]


def test_groups_share_out_every_cell_region_by_region():
    kappa = 1.0 + MESH.region
    averaging = make_averaging(MESH, kappa)
    assert averaging.volumes.sum() == pytest.approx(MESH.cell_volumes.sum())
    np.testing.assert_array_equal(
        averaging.kappa[averaging.groups], np.repeat(kappa[:, None], 4, axis=1)
    )
    corners = averaging.points[averaging.place]
    np.testing.assert_array_equal(corners, np.tile(MESH.cells[:, None], (1, 4, 1)))
    on_interface = np.intersect1d(
        MESH.cells[MESH.region == 0], MESH.cells[MESH.region == 1]
    )
    assert len(averaging.volumes) == MESH.n_points + len(on_interface)


@pytest.mark.parametrize("elements", ELEMENTS)
@given(seed=st.integers(0, 10_000))
def test_forces_are_the_derivative_of_energy_and_balance(elements, seed):
    check_forces_derive_from_energy(elements, MESH, seed)


@pytest.mark.parametrize("elements", ELEMENTS)
@given(seed=st.integers(0, 10_000))
@settings(max_examples=20)
def test_tangent_is_the_derivative_of_force(elements, seed):
    check_tangent(elements, MESH, seed)


@pytest.mark.parametrize("element", ["tet4", "tet4-averaged"])
def test_cells_about_a_point_give_its_rows_of_the_tangent(element):
    body = Body(MESH, BODIES[0], element=element)
    u, pattern = wobble(MESH, 5), body.pattern
    point = int(pattern.free[0])
    cells = np.flatnonzero((MESH.cells == point).any(axis=1))
    whole, _ = assemble_tangent(body.elements, pattern, u)
    part, _ = assemble_tangent(body.elements, pattern, u, cells=cells)
    rows = slice(*pattern.indptr[[0, 3]])
    np.testing.assert_array_equal(part[rows], whole[rows])
    assert not np.array_equal(part, whole)


@pytest.mark.parametrize("elements", ELEMENTS)
def test_uniform_strain_costs_what_it_costs_without_averaging(elements):
    plain = make_elements(MESH, BODIES[ELEMENTS.index(elements)])
    F = np.array([[1.1, 0.2, 0.0], [0.0, 0.9, 0.1], [-0.1, 0.0, 1.05]])
    u = MESH.points @ (F - np.eye(3)).T
    assert strain_energy(elements, u) == pytest.approx(strain_energy(plain, u))
    Q = Rotation.random(random_state=3).as_matrix()
    turned = (MESH.points + u) @ Q.T - MESH.points
    np.testing.assert_allclose(
        internal_force(elements, turned)[0],
        internal_force(elements, u)[0] @ Q.T,
        atol=1e-12,
    )


def test_an_inverted_cell_is_named():
    u = np.zeros_like(MESH.points)
    u[13] = [30.0, 0.0, 0.0]
    plain = make_elements(MESH, BODIES[0])
    assert internal_force(ELEMENTS[0], u)[1] == internal_force(plain, u)[1] >= 0
    assert strain_energy(ELEMENTS[0], u) == np.inf


def test_the_rest_state_is_softer_where_tetrahedra_lock():
    mesh = block_mesh(4)
    body = {0: NeoHookean(3000.0, 0.4999), 1: NeoHookean(3000.0, 0.4999)}
    force = np.zeros_like(mesh.points)
    force[mesh.point_set("loaded"), 0] = 1e-4
    locked, free = (
        np.abs(RestState(Body(mesh, body, element=element)).solve(force)).max()
        for element in ("tet4", "tet4-averaged")
    )
    assert free > 1.15 * locked


def test_an_unknown_element_is_refused():
    with pytest.raises(InputError, match="element must be one of tet4, tet4-averaged"):
        make_elements(MESH, BODIES[0], "hex8")

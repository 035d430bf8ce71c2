"""The discretised body: kinematics, forces and tangent against mathematics."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from element_checks import (
    check_forces_derive_from_energy,
    check_objectivity,
    check_tangent,
    wobble,
)
from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry import without_unused_points
from physgnn.geometry.regions import BRAIN, VENTRICLE
from physgnn.mechanics.elements.cell_kinematics import (
    deformation_gradient,
    volume_change_range,
)
from physgnn.mechanics.elements.tet4 import (
    internal_force,
    make_elements,
    strain_energy,
)
from physgnn.mechanics.materials import TISSUES, MooneyRivlin, NeoHookean

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
MESH = block_mesh(2, jitter=0.15)
ELEMENTS = make_elements(MESH, MATERIALS)


@given(seed=st.integers(0, 10_000))
def test_deformation_gradient_of_an_affine_motion(seed):
    F = np.eye(3) + np.random.default_rng(seed).uniform(-0.5, 0.5, (3, 3))
    u = MESH.points @ (F - np.eye(3)).T + seed % 7
    np.testing.assert_allclose(
        deformation_gradient(MESH, u), np.broadcast_to(F, (MESH.n_cells, 3, 3)),
        atol=1e-12,
    )  # fmt: skip


def test_fluid_that_leaves_a_ventricle_is_no_change_of_tissue():
    """It was: one cell of a ventricle made a whole registration implausible."""
    mesh = block_mesh(3, side=30.0)
    u = np.zeros_like(mesh.points)
    u[:, 2] = -0.6 * np.maximum(mesh.points[:, 2] - 20.0, 0.0)
    pressed = np.linalg.det(deformation_gradient(mesh, u)) < 0.9
    fluid = replace(mesh, region=np.where(pressed, VENTRICLE, BRAIN))
    assert volume_change_range(mesh, u)[0] < 0.5
    assert volume_change_range(fluid, u)[0] >= 0.9
    assert volume_change_range(fluid, 3 * u)[0] < 0.0, "turned inside out"
    alone = replace(mesh, region=np.full(mesh.n_cells, VENTRICLE))
    assert volume_change_range(alone, u) == volume_change_range(mesh, u)


@given(seed=st.integers(0, 10_000))
def test_rigid_motion_makes_no_force_and_no_energy(seed):
    Q = Rotation.random(random_state=seed).as_matrix()
    u = MESH.points @ Q.T - MESH.points + [1.0, -2.0, 3.0]
    force, inverted = internal_force(ELEMENTS, u)
    assert inverted == -1
    np.testing.assert_allclose(force, 0, atol=1e-12)
    assert strain_energy(ELEMENTS, u) == pytest.approx(0, abs=1e-12)


def test_patch_test():
    """Under an affine motion of one material, points inside carry no force."""
    alone = make_elements(MESH, {0: MATERIALS[0], 1: MATERIALS[0]})
    F = np.array([[1.1, 0.2, 0.0], [0.0, 0.9, 0.1], [-0.1, 0.0, 1.05]])
    force, _ = internal_force(alone, MESH.points @ (F - np.eye(3)).T)
    inside = ((MESH.points > 0) & (MESH.points < 10)).all(axis=1)
    assert inside.any()
    np.testing.assert_allclose(force[inside], 0, atol=1e-13)
    assert np.abs(force[~inside]).max() > 1e-3


@given(seed=st.integers(0, 10_000))
def test_forces_are_the_derivative_of_energy_and_balance(seed):
    check_forces_derive_from_energy(ELEMENTS, MESH, seed)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=20)
def test_rotating_the_deformed_body_rotates_the_forces(seed):
    check_objectivity(ELEMENTS, MESH, seed)


def test_point_order_does_not_matter():
    order = np.random.default_rng(0).permutation(MESH.n_points)
    rank = np.argsort(order)
    other = type(MESH)(MESH.points[order], rank[MESH.cells], MESH.region)
    u = wobble(MESH, 3)
    force, _ = internal_force(make_elements(other, MATERIALS), u[order])
    expected = internal_force(ELEMENTS, u)[0][order]
    np.testing.assert_allclose(force, expected, atol=1e-14)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=20)
def test_tangent_is_the_derivative_of_force_and_symmetric(seed):
    check_tangent(ELEMENTS, MESH, seed)


def test_an_inverted_cell_is_named():
    u = np.zeros_like(MESH.points)
    a, b, c, d = MESH.points[MESH.cells[5]]
    normal = np.cross(b - a, c - a)
    u[MESH.cells[5, 3]] = -2 * normal * ((d - a) @ normal) / (normal @ normal)
    _, inverted = internal_force(ELEMENTS, u)
    J = np.linalg.det(deformation_gradient(MESH, u))
    assert inverted == np.flatnonzero(J <= 0)[0]
    assert strain_energy(ELEMENTS, u) == np.inf


def test_every_cell_follows_its_own_law():
    """Forces of a body of two laws are those of its two halves, each of one law."""
    brain, gel = TISSUES["brain-ogden"].material, MooneyRivlin(300.0, 200.0, 2e4)
    u = wobble(MESH, 5)
    for first, second in ((brain, gel), (MATERIALS[0], brain), (gel, MATERIALS[0])):
        mixed = make_elements(MESH, {0: first, 1: second})
        halves = np.zeros_like(u)
        for label, material in ((0, first), (1, second)):
            inside = MESH.region == label
            half, used = without_unused_points(
                MESH.points, MESH.cells[inside], MESH.region[inside]
            )
            elements = make_elements(half, {label: material})
            halves[used] += internal_force(elements, u[used])[0]
        np.testing.assert_allclose(internal_force(mixed, u)[0], halves, atol=1e-15)


@pytest.mark.parametrize("shape", [(MESH.n_points - 1, 3), (MESH.n_points, 2), (3,)])
def test_kernels_get_one_row_a_point(shape):
    elements = make_elements(MESH, MATERIALS)
    for kernel in (internal_force, strain_energy):
        with pytest.raises(InputError, match="one row a point"):
            kernel(elements, np.zeros(shape))


def test_a_region_without_material_is_refused():
    with pytest.raises(InputError, match="region 1 has no material"):
        make_elements(MESH, {0: MATERIALS[0]})

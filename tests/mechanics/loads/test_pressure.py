"""Pressure that follows its surface: resultants, work, and a hydrostatic body."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.mechanics import LoadPath, NeoHookean, SolverOptions, solve
from physgnn.mechanics.elements.tet4 import internal_force, make_elements
from physgnn.mechanics.loads.pressure import SurfacePressure, faces_within

MESH = block_mesh(2, jitter=0.15)
CLOSED = SurfacePressure(boundary_faces(MESH), 400.0)
SOFT = NeoHookean(3000.0, 0.4)


def volume(x):
    a, b, c = x[CLOSED.faces].transpose(1, 0, 2)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


@given(seed=st.integers(0, 10_000))
def test_a_closed_surface_has_no_resultant_and_no_moment(seed):
    u = np.random.default_rng(seed).uniform(-0.3, 0.3, MESH.points.shape)
    force = CLOSED.bind(MESH)(u, 1.0)
    np.testing.assert_allclose(force.sum(axis=0), 0, atol=1e-14)
    moment = np.cross(MESH.points + u, force).sum(axis=0)
    np.testing.assert_allclose(moment, 0, atol=1e-13)


@given(seed=st.integers(0, 10_000))
def test_work_of_pressure_is_minus_pressure_times_volume(seed):
    rng = np.random.default_rng(seed)
    u, v = rng.uniform(-0.3, 0.3, (2, *MESH.points.shape))
    h = 1e-5
    x = MESH.points + u
    slope = (volume(x + h * v) - volume(x - h * v)) / (2 * h)
    work = (CLOSED.bind(MESH)(u, 0.5) * v).sum()
    assert work == pytest.approx(-0.5 * 400e-6 * slope, rel=1e-6, abs=1e-10)


def test_a_uniformly_squeezed_body_is_in_equilibrium():
    """All points at s X: σ = −p I throughout, so pressure p balances every point."""
    mu, lam, p = SOFT.mu, SOFT.lam, 400e-6

    def pressure_of(s):
        return -(mu * (s**2 - 1) + lam * np.log(s**3)) / s**3

    s = brentq(lambda s: pressure_of(s) - p, 0.8, 1.0, xtol=1e-15)
    u = (s - 1) * MESH.points
    inside, _ = internal_force(make_elements(MESH, {0: SOFT, 1: SOFT}), u)
    np.testing.assert_allclose(inside, CLOSED.bind(MESH)(u, 1.0), atol=1e-13)


def test_pressure_turns_with_the_surface(block):
    top = SurfacePressure(faces_within(block, "loaded"), -600.0)
    path = LoadPath.of(np.arange(1, 5) / 4, top)
    options = SolverOptions(tolerance_mm=1e-8)
    solution = solve(block, path, materials={0: SOFT, 1: SOFT}, options=options)
    assert solution.converged and solution.residual.max() < 1e-7
    u = solution.displacement[-1]
    assert u[block.point_set("loaded"), 2].mean() > 1.0, "suction pulls it up"
    force, _ = internal_force(make_elements(block, {0: SOFT, 1: SOFT}), u)
    free = np.setdiff1d(np.arange(block.n_points), block.point_set("fixed"))
    np.testing.assert_allclose(force[free], top.bind(block)(u, 1.0)[free], atol=1e-9)


@pytest.mark.parametrize(
    ("faces", "pressure", "message"),
    [
        (np.zeros((0, 3), int), 1.0, "n_faces ≥ 1"),
        ([[0, 1]], 1.0, "must have shape"),
        ([[0, 1, 2]], 0.0, "not 0"),
        ([[0, 1, 2]], np.nan, "finite"),
    ],
)
def test_a_wrong_pressure_is_refused(faces, pressure, message):
    with pytest.raises(InputError, match=message):
        SurfacePressure(faces, pressure)


def test_faces_must_be_of_the_mesh_and_outside(block):
    with pytest.raises(InputError, match="faces must index 0…63"):
        SurfacePressure([[0, 1, 64]], 1.0).check_against(block)
    with pytest.raises(InputError, match="no outer face"):
        faces_within(block, np.array([0]))
    assert len(faces_within(block, "loaded")) == 2 * 3**2

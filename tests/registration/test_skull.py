import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.mechanics import NeoHookean
from physgnn.mechanics.body import Body
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.registration.skull import (
    ACROSS_MM,
    ALONG_MM,
    fixed_support,
    point_areas,
    sliding_support,
)
from physgnn.registration.tangent_response import TangentResponse

MATERIALS = {0: NeoHookean(3000.0, 0.4), 1: NeoHookean(3000.0, 0.4)}
SIDE = 60.0


def test_areas_add_up_to_the_surface() -> None:
    assert point_areas(block_mesh(3, side=SIDE)).sum() == pytest.approx(6 * SIDE**2)


def test_springs_resist_leaving_far_more_than_sliding() -> None:
    mesh = block_mesh(4, side=SIDE)
    floor = mesh.points[:, 2] == 0
    inner = floor & (mesh.points[:, :2] > 0).all(1) & (mesh.points[:, :2] < SIDE).all(1)
    points = np.flatnonzero(inner)
    support = sliding_support(Body(mesh, MATERIALS, points))
    assert len(support.held) == 0
    mu, area = MATERIALS[0].mu, (SIDE / 4) ** 2
    for spring in support.stiffness:
        values = np.linalg.eigvalsh(spring)
        wanted = mu * area / np.array([ALONG_MM, ALONG_MM, ACROSS_MM])
        np.testing.assert_allclose(values, wanted)
        np.testing.assert_allclose(spring @ [0, 0, 1], [0, 0, wanted[2]], atol=1e-12)


def test_the_tangent_is_the_derivative_of_the_force() -> None:
    """A block on a sliding floor: what it answers is what balances the load."""
    mesh = block_mesh(3, side=SIDE)
    floor = np.flatnonzero(mesh.points[:, 2] == 0)
    body = Body(mesh, MATERIALS, floor)
    support = sliding_support(body)
    tangent = TangentResponse(body, support)
    push = np.zeros((1, mesh.n_points, 3), dtype=np.float32)
    push[0, mesh.point_set("loaded"), 0] = 1e-4
    rest = np.zeros_like(mesh.points)
    moved, _ = tangent(rest, push)
    force = np.zeros_like(rest)
    support.add_force(moved[0].astype(float), force)
    # the springs alone hold the body: they carry the whole push
    np.testing.assert_allclose(force.sum(0), push[0].sum(0), atol=1e-3 * push.sum())
    x, y, z = mesh.points.T
    inner = (x > 0) & (x < SIDE) & (y > 0) & (y < SIDE) & (z == 0)
    lifted, slid = np.abs(moved[0, inner, 2]), np.abs(moved[0, inner, 0])
    assert lifted.max() < 0.05 * slid.mean()


def test_a_fixed_skull_is_the_rest_state_solver() -> None:
    mesh = block_mesh(3, side=SIDE)
    body = Body(mesh, MATERIALS)
    support = fixed_support(body)
    push = np.random.default_rng(0).normal(size=(2, mesh.n_points, 3)) * 1e-3
    tangent = TangentResponse(body, support)
    moved, back = tangent(np.zeros_like(mesh.points), push.astype(np.float32))
    rest = RestState(body)
    np.testing.assert_allclose(moved, rest.solve(push), atol=1e-4 * np.abs(moved).max())
    assert not back.any()


def test_points_inside_cannot_slide_along_the_skull() -> None:
    mesh = block_mesh(3, side=SIDE)
    inside = (mesh.points > 0).all(axis=1) & (mesh.points < SIDE).all(axis=1)
    with pytest.raises(InputError, match="outer surface"):
        sliding_support(Body(mesh, MATERIALS, np.flatnonzero(inside)))

"""The force left near loads: none in equilibrium, and none told beyond."""

import numpy as np
import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import NeoHookean
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.reduced.submodels.force_left import ForceLeft

MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(7500.0, 0.45)}


@pytest.fixture
def somewhere(block: TetMesh) -> tuple[Body, np.ndarray, np.ndarray]:
    """Return a body, a displacement of it, and the force that holds it there."""
    body = Body(block, MATERIALS)
    u = np.random.default_rng(0).normal(scale=0.02, size=(block.n_points, 3))
    force, inverted = internal_force(body.elements, u)
    assert inverted < 0
    return body, u, force


def test_what_holds_a_displacement_leaves_nothing(somewhere) -> None:
    body, u, force = somewhere
    left = ForceLeft(body, np.ones(len(u), dtype=bool))(force, u)
    np.testing.assert_allclose(left, 0.0, atol=1e-12)


def test_what_is_added_to_it_is_left_at_points_near_and_free(somewhere) -> None:
    body, u, force = somewhere
    more = np.random.default_rng(1).normal(size=force.shape)
    near = np.zeros(len(u), dtype=bool)
    near[::3] = True
    near[body.fixed[0]] = True
    found = ForceLeft(body, near)
    told = near.copy()
    told[body.fixed] = False
    np.testing.assert_array_equal(found.points, np.flatnonzero(told))
    expected = np.where(told[:, None], more, 0.0)
    np.testing.assert_allclose(found(force + more, u), expected, atol=1e-12)
    left = found.at_points(force + more, u)
    np.testing.assert_allclose(left, more[told], atol=1e-12)


def test_averaged_elements_tell_nothing(somewhere) -> None:
    body, u, force = somewhere
    averaged = Body(body.mesh, MATERIALS, element="tet4-averaged")
    found = ForceLeft(averaged, np.ones(len(u), dtype=bool))
    assert not found(force + 1.0, u).any()
    assert not found.at_points(force + 1.0, u).any()

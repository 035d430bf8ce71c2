"""Kept columns of K⁻¹ against back-solves."""

import numpy as np
import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.linear.direct_solver import factorized
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.reduced.expansions import point_responses
from physgnn.mechanics.reduced.expansions.point_responses import PointResponses

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}


def responses(mesh: TetMesh, nodes: np.ndarray) -> PointResponses:
    body = Body(mesh, MATERIALS)
    solver = factorized(body, np.zeros_like(mesh.points), precision="single")
    assert solver is not None
    return PointResponses(solver, body.pattern, nodes)


def random_force(mesh: TetMesh, nodes: np.ndarray) -> np.ndarray:
    force = np.zeros_like(mesh.points)
    force[nodes] = np.random.default_rng(0).normal(size=(len(nodes), 3)) * 1e-2
    return force


@pytest.mark.parametrize("where", ["known", "other", "both", "fixed", "none"])
@pytest.mark.parametrize("memory", [point_responses.MAX_BYTES, 0])
def test_any_load_has_its_linear_solution(
    block: TetMesh, where: str, memory: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(point_responses, "MAX_BYTES", memory)
    top = block.point_set("loaded")
    nodes = {
        "known": top[:6],
        "other": top[6:],
        "both": top,
        "fixed": np.append(block.point_set("fixed"), top[:2]),
        "none": top[:0],
    }[where]
    force = random_force(block, nodes)
    expected = RestState(Body(block, MATERIALS)).solve(force)
    found = responses(block, top[:6])(force)
    np.testing.assert_allclose(found, expected, atol=1e-5 * np.abs(expected).max())


def test_fixed_points_stay_put_exactly(block: TetMesh) -> None:
    top = block.point_set("loaded")
    found = responses(block, top)(random_force(block, top))
    assert (found[block.point_set("fixed")] == 0).all()


def test_a_response_is_the_same_whatever_was_asked_for_before(
    block: TetMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Columns are made when a load first acts on them, always the same ones at once."""
    monkeypatch.setattr(point_responses, "AT_ONCE", 6)
    top = block.point_set("loaded")
    one, all_of_them = random_force(block, top[:1]), random_force(block, top)
    fresh, used = responses(block, top), responses(block, top)
    used(all_of_them)
    np.testing.assert_array_equal(fresh(one), used(one))
    np.testing.assert_array_equal(fresh(all_of_them), used(all_of_them))

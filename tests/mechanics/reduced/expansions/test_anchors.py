"""Expand about states under the mean of loads of one kind, else where they gather."""

import numpy as np
import pytest

from physgnn.arrays import FloatArray
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import Body, LoadPath, NeoHookean, RestState
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.equilibrium.solver import Solver, SolverOptions
from physgnn.mechanics.reduced.expansions import anchors as module
from physgnn.mechanics.reduced.expansions.anchors import (
    LOADS_A_CLUSTER,
    expected_anchors,
    loads_held_by,
)
from physgnn.mechanics.reduced.expansions.asymptotic import AsymptoticExpansion
from physgnn.mechanics.reduced.submodels.near_loads import FEW

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}


@pytest.fixture
def body(block: TetMesh) -> Body:
    return Body(block, MATERIALS, block.point_set("fixed"))


def pushes(body: Body, n_places: int, n_loads: int) -> FloatArray:
    """Return loads on one point each, of some places in turn, in directions drawn."""
    rng = np.random.default_rng(0)
    top = body.mesh.point_set("loaded")
    places = top[np.linspace(0, len(top) - 1, n_places).astype(int)]
    forces = np.zeros((n_loads, *body.mesh.points.shape))
    for k, force in enumerate(forces):
        push = np.array([0.0, 0.0, -1.0]) + 0.05 * rng.normal(size=3)
        force[places[k % n_places]] = 0.012 * push
    return forces


def held(body: Body, state: FloatArray) -> FloatArray:
    """Return the load that a state is in equilibrium with, N."""
    force, inverted = internal_force(body.elements, state)
    assert inverted < 0
    force[body.fixed] = 0.0
    return force


def along_the_mean(body: Body, forces: FloatArray, states: FloatArray) -> bool:
    """Return whether all states' loads are multiples of the loads' mean."""
    mean = forces.mean(axis=0)
    mean /= np.linalg.norm(mean)
    loads = np.stack([held(body, state) for state in states])
    across = loads - np.tensordot(loads, mean, axes=2)[:, None, None] * mean
    return bool(np.linalg.norm(across) < 1e-3 * np.linalg.norm(loads))


def test_loads_in_one_place_have_states_under_their_mean(body: Body) -> None:
    forces = pushes(body, 1, 30)
    assert along_the_mean(body, forces, expected_anchors(body, forces, 6))


def test_loads_in_two_places_have_a_state_in_each(body: Body) -> None:
    forces = pushes(body, 2, 30)
    states = expected_anchors(body, forces, 2)
    assert not along_the_mean(body, forces, states)
    places = [np.linalg.norm(held(body, state), axis=1).argmax() for state in states]
    assert sorted(places) == np.flatnonzero(forces.any(axis=(0, 2))).tolist()


def test_a_few_loads_have_no_states_of_their_own(body: Body) -> None:
    forces = pushes(body, 2, 2 * LOADS_A_CLUSTER - 1)
    assert along_the_mean(body, forces, expected_anchors(body, forces, 2))


def test_forces_on_single_points_need_a_state_for_each_place(body: Body) -> None:
    forces = pushes(body, 3, 30)
    assert along_the_mean(body, forces, expected_anchors(body, forces, 2))
    assert not along_the_mean(body, forces, expected_anchors(body, forces, 3))


def test_patches_need_none_for_each_place(body: Body) -> None:
    forces = pushes(body, 3, 30)
    beside = body.mesh.point_set("loaded")[: FEW + 1]
    forces[:, beside] += [0.0, 0.0, -1e-4]
    assert not along_the_mean(body, forces, expected_anchors(body, forces, 2))


def test_loads_never_seen_are_expanded_better_about_clusters(
    body: Body, monkeypatch: pytest.MonkeyPatch
) -> None:
    forces = pushes(body, 2, 34)
    known, others = forces[:30], forces[30:]
    exact = SolverOptions(tolerance_mm=1e-7)

    def missed() -> float:
        expansion = AsymptoticExpansion(body, expected_anchors(body, known, 4))
        errors = []
        for force in others:
            nodes = np.flatnonzero(force.any(axis=1))
            path = LoadPath(nodes, force[nodes], np.ones(1))
            truth = Solver(body, options=exact).solve(path).displacement[0]
            errors.append(np.abs(expansion.expand(force).displacement - truth).mean())
        return float(np.mean(errors))

    clustered = missed()
    monkeypatch.setattr(module, "BETTER", 0.0)
    assert clustered < 0.7 * missed()


def test_loads_that_cancel_have_states_where_they_gather(body: Body) -> None:
    forces = pushes(body, 1, 10)
    both = np.concatenate([forces, -forces])
    states = expected_anchors(body, both, 2)
    up = [held(body, state)[:, 2].sum() for state in states]
    assert min(up) < -0.005
    assert max(up) > 0.005


def test_forces_on_fixed_points_do_not_count(body: Body) -> None:
    forces = pushes(body, 2, 20)
    expected = expected_anchors(body, forces, 2)
    forces[:, body.fixed] = 5.0
    np.testing.assert_allclose(expected_anchors(body, forces, 2), expected, atol=1e-9)


def test_no_load_has_no_state(body: Body) -> None:
    nothing = np.zeros((20, *body.mesh.points.shape))
    assert not expected_anchors(body, nothing, 3).any()
    assert expected_anchors(body, pushes(body, 1, 20), 0).shape[0] == 0


def test_a_state_tells_the_load_it_holds(body: Body) -> None:
    states = expected_anchors(body, pushes(body, 2, 30), 2)
    rest = RestState(body)
    cases = list(loads_held_by(body, np.concatenate([states, 0 * states[:1]])))
    assert len(cases) == 2
    for case, state in zip(cases, states, strict=True):
        linear = rest.solve(case.on_points(body.mesh.n_points))
        assert np.linalg.norm(linear - state) < 0.5 * np.linalg.norm(state)

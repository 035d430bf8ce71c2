"""The expansion about an equilibrium, against the solver that iterates."""

from dataclasses import replace

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.mesh_topology import points_within
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import ELEMENTS
from physgnn.mechanics.equilibrium.solver import Solver, SolverOptions
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.reduced.expansions.anchors import expected_anchors
from physgnn.mechanics.reduced.expansions.asymptotic import AsymptoticExpansion

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
EXACT = SolverOptions(tolerance_mm=1e-7)


@pytest.fixture
def body(block: TetMesh) -> Body:
    return Body(block, MATERIALS, block.point_set("fixed"))


@pytest.fixture
def force(block: TetMesh) -> np.ndarray:
    """A push on part of the top that moves it by about 1 mm."""
    field = np.zeros_like(block.points)
    field[block.point_set("loaded")[:8]] = [4e-3, 1e-3, -8e-3]
    return field


def equilibria(body: Body, force: np.ndarray, factors: np.ndarray) -> np.ndarray:
    nodes = np.flatnonzero(force.any(axis=1))
    path = LoadPath(nodes, force[nodes], factors)
    solution = Solver(body, options=EXACT).solve(path)
    assert solution.converged
    return solution.displacement


def rate(sizes: np.ndarray, errors: list[float]) -> float:
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("about", ["rest", "anchor"])
@pytest.mark.parametrize("exponential", [True, False])
def test_error_falls_with_the_third_power_of_the_load(
    body: Body, force: np.ndarray, about: str, element: str, exponential: bool
) -> None:
    body = replace(body, element=element)
    sideways = np.zeros_like(force)
    sideways[body.mesh.point_set("loaded")[4:9]] = [8e-3, -4e-3, 4e-3]
    anchors = np.zeros((0, *force.shape))
    start = np.zeros_like(force)
    if about == "anchor":
        anchors, start = equilibria(body, force, np.array([1.0])), force
    strained = np.ones(len(force), dtype=bool) if exponential else None
    expansion = AsymptoticExpansion(body, anchors, strained=strained)
    sizes = np.array([0.4, 0.3, 0.2])
    if element == "tet4-averaged":  # softer
        sizes /= 2
    first, second = [], []
    for size in sizes:
        load = start + size * sideways
        truth = equilibria(body, load, np.array([1.0]))[0]
        terms = expansion.expand(load)
        first.append(np.abs(terms.anchor + terms.first - truth).max())
        second.append(np.abs(terms.displacement - truth).max())
    assert 1.8 < rate(sizes, first) < 2.3
    assert rate(sizes, second) > 2.7


def test_first_term_about_rest_is_the_linear_solution(
    body: Body, force: np.ndarray
) -> None:
    terms = AsymptoticExpansion(body, np.zeros((0, *force.shape))).expand(force)
    linear = RestState(Body(body.mesh, MATERIALS)).solve(force)
    assert (terms.anchor == 0).all()
    np.testing.assert_allclose(terms.first, linear, atol=1e-5 * np.abs(linear).max())


def test_expands_about_the_nearest_anchor(body: Body, force: np.ndarray) -> None:
    anchors = equilibria(body, force, np.array([0.5, 1.0]))
    expansion = AsymptoticExpansion(body, anchors)
    assert [expansion.nearest(s * force) for s in (0.1, 0.4, 0.6, 0.9, 3)] == [
        0, 1, 1, 2, 2
    ]  # fmt: skip
    np.testing.assert_allclose(
        expansion.expand(force).displacement, anchors[1], atol=1e-5
    )


def test_a_load_far_beyond_any_still_has_an_expansion(
    body: Body, force: np.ndarray
) -> None:
    for strained in (None, np.ones(len(force), dtype=bool)):
        expansion = AsymptoticExpansion(
            body, np.zeros((0, *force.shape)), strained=strained
        )
        assert np.isfinite(expansion.expand(1e3 * force).displacement).all()


def test_the_third_term_is_that_of_the_strained_cells(
    body: Body, force: np.ndarray
) -> None:
    none, everywhere = np.zeros((0, *force.shape)), np.ones(len(force), dtype=bool)
    whole = AsymptoticExpansion(body, none, strained=everywhere).expand(force).third
    near = points_within(body.mesh, np.flatnonzero(force.any(axis=1)), 1)
    part = AsymptoticExpansion(body, none, strained=near).expand(force).third
    nowhere = AsymptoticExpansion(body, none, strained=~everywhere)
    assert (nowhere.expand(force).third == 0).all()
    assert np.abs(part - whole).max() < 0.5 * np.abs(whole).max()


def test_refuses_an_inverted_anchor(body: Body) -> None:
    anchors = np.random.default_rng(0).normal(size=(1, *body.mesh.points.shape)) * 50
    with pytest.raises(InputError, match="inverted in an anchor"):
        AsymptoticExpansion(body, anchors)


def test_anchors_reach_the_largest_projection_on_the_mean(
    body: Body, force: np.ndarray
) -> None:
    forces = np.stack([0.3 * force, 0.6 * force, 0.9 * force])
    anchors = expected_anchors(body, forces, 3)
    expected = equilibria(body, 0.9 * force, np.array([1 / 3, 2 / 3, 1.0]))
    np.testing.assert_allclose(anchors, expected, atol=1e-3)


def test_opposite_loads_have_no_anchor_but_rest(body: Body, force: np.ndarray) -> None:
    assert (expected_anchors(body, np.stack([force, -force]), 2) == 0).all()


def test_a_bound_on_memory_changes_no_displacement(
    body: Body, force: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    anchors = equilibria(body, force, np.array([0.5, 1.0]))
    loads = [s * force for s in (0.1, 0.9, 0.5, 0.1)]
    whole = AsymptoticExpansion(body, anchors)
    expected = [whole.expand(load).displacement for load in loads]
    monkeypatch.setenv("PHYSGNN_CACHE_GB", "1e-9")  # room for the last one alone
    bounded = AsymptoticExpansion(body, anchors)
    for load, displacement in zip(loads, expected, strict=True):
        assert (bounded.expand(load).displacement == displacement).all()
        assert len(bounded._responses) == 1

"""The inverse of a stiffness of which only a part is up to date."""

import numpy as np
import pytest

from element_checks import condensed
from physgnn.mechanics import NeoHookean
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent
from physgnn.mechanics.elements.tet4 import ELEMENTS
from physgnn.mechanics.linear.condensation import Condensation
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.linear.protocols import LinearSolver

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
SINGLE = 2e-5  # relative; factors are in single precision


@pytest.fixture(scope="module", params=ELEMENTS)
def body(block, request):
    return Body(block, MATERIALS, element=request.param)


@pytest.fixture(scope="module")
def factor_at_rest(body):
    solver = make_linear_solver(body.pattern, precision="single")
    assert solver.factorize(values(body, np.zeros((body.mesh.n_points, 3))))
    return solver


def values(body: Body, u: np.ndarray) -> np.ndarray:
    data, inverted = assemble_tangent(body.elements, body.pattern, u)
    assert inverted < 0
    return data


def dense(body: Body, data: np.ndarray) -> np.ndarray:
    return condensed(body.pattern, data)


def moved(body: Body, points: np.ndarray, seed: int) -> np.ndarray:
    u = np.zeros((body.mesh.n_points, 3))
    u[points] = np.random.default_rng(seed).normal(size=(len(points), 3))
    return 0.01 * u * np.cbrt(body.mesh.cell_volumes.min())


def some(body: Body, n: int) -> np.ndarray:
    return np.sort(np.random.default_rng(7).permutation(body.pattern.free)[:n])


def test_it_is_the_inverse_while_nothing_has_changed(body, factor_at_rest):
    solver = Condensation(body.pattern, some(body, 6), factor_at_rest)
    assert solver.factorize(values(body, np.zeros((body.mesh.n_points, 3))))
    b = np.random.default_rng(2).normal(size=body.pattern.n_unknowns)
    exact = factor_at_rest.solve(b)
    np.testing.assert_allclose(
        solver.solve(b), exact, atol=SINGLE * np.abs(exact).max()
    )


def test_it_is_nearer_to_the_inverse_than_the_earlier_factor(body, factor_at_rest):
    """The eigenvalues of what it makes of K lie closer together."""
    inner = some(body, 2)
    cells = np.isin(body.mesh.cells, inner).any(axis=1)
    part = np.intersect1d(body.mesh.cells[cells], body.pattern.free)
    data = values(body, moved(body, inner, seed=1))
    solver = Condensation(body.pattern, part, factor_at_rest)
    assert solver.factorize(data)
    assert spread(solver, dense(body, data)) < spread(factor_at_rest, dense(body, data))


def spread(solver: LinearSolver, K: np.ndarray) -> float:
    product = np.array([solver.solve(column) for column in K])
    values = np.linalg.eigvals(product).real
    return values.max() / values.min()


@pytest.mark.parametrize("n", [1, 5, 1000])
def test_it_is_symmetric_and_positive_definite(body, factor_at_rest, n):
    part = some(body, n)
    solver = Condensation(body.pattern, part, factor_at_rest)
    assert solver.factorize(values(body, moved(body, body.pattern.free, seed=3)))
    inverse = np.array([solver.solve(e) for e in np.eye(body.pattern.n_unknowns)])
    size = np.abs(inverse).max()
    np.testing.assert_allclose(inverse, inverse.T, atol=SINGLE * size)
    assert np.linalg.eigvalsh(inverse + inverse.T).min() > 0


def test_the_part_is_solved_exactly_for_what_lies_beside_it(body, factor_at_rest):
    """The rows of the part hold in K u = b, whatever the rest is."""
    part = some(body, 6)
    data = values(body, moved(body, body.pattern.free, seed=4))
    solver = Condensation(body.pattern, part, factor_at_rest)
    assert solver.factorize(data)
    b = np.random.default_rng(5).normal(size=body.pattern.n_unknowns)
    left = b - dense(body, data) @ solver.solve(b)
    rows = body.pattern.row[part]
    inside = left.reshape(-1, 3)[rows]
    assert np.abs(inside).max() < 1e-3 * np.abs(left).max()


def test_a_part_without_a_positive_definite_stiffness_is_refused(body, factor_at_rest):
    solver = Condensation(body.pattern, some(body, 4), factor_at_rest)
    assert not solver.factorize(-values(body, np.zeros((body.mesh.n_points, 3))))

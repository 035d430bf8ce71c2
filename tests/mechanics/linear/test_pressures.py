"""Kept as unknowns, the pressures change no answer, and tell what is unstable."""

import numpy as np
import pytest

from element_checks import condensed, wobble
from physgnn.mechanics import NeoHookean
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent
from physgnn.mechanics.linear.direct_solver import SuperLUSolver, make_linear_solver

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.499)}
SOLVERS = [make_linear_solver, SuperLUSolver]


@pytest.fixture(scope="module")
def body(block):
    return Body(block, MATERIALS, element="tet4-averaged")


def values(body: Body, u: np.ndarray) -> np.ndarray:
    data, inverted = assemble_tangent(body.elements, body.pattern, u)
    assert inverted < 0
    return data


@pytest.mark.parametrize("make", SOLVERS)
def test_the_answer_is_that_of_the_stiffness_without_them(body, make):
    pattern = body.pattern
    data = values(body, wobble(body.mesh, 3, size=0.003))
    K = condensed(pattern, data)
    solver = make(pattern)
    assert solver.factorize(data)
    right = np.random.default_rng(0).standard_normal((4, pattern.n_unknowns))
    expected = np.linalg.solve(K, right.T).T
    found = solver.solve(right)
    scale = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, atol=1e-9 * scale)
    np.testing.assert_allclose(solver.solve(right[0]), found[0], atol=1e-12 * scale)


def test_a_factor_in_single_precision_is_as_good_as_its_digits(body):
    data = values(body, wobble(body.mesh, 3, size=0.003))
    solver = make_linear_solver(body.pattern, precision="single")
    assert solver.factorize(data)
    right = np.random.default_rng(0).standard_normal(body.pattern.n_unknowns)
    expected = np.linalg.solve(condensed(body.pattern, data), right)
    found = solver.solve(right)
    np.testing.assert_allclose(found, expected, atol=2e-4 * np.abs(expected).max())


@pytest.mark.parametrize("make", SOLVERS)
def test_a_negative_eigenvalue_is_counted(body, make):
    """Taking a little more or less than the k-th eigenvalue off the diagonal."""
    data = values(body, np.zeros_like(body.mesh.points))
    eigenvalues = np.linalg.eigvalsh(condensed(body.pattern, data))
    solver = make(body.pattern)
    for shift, stable in (
        (0.99 * eigenvalues[0], True),
        (1.01 * eigenvalues[0], False),
        (1.01 * eigenvalues[20], False),
    ):
        shifted = data.copy()
        body.pattern.add_to_diagonal(shifted, np.full(body.mesh.n_points, -shift))
        assert solver.factorize(shifted) == stable
        assert solver.factorize(shifted) == stable, "and when it is asked again"


@pytest.mark.parametrize("make", SOLVERS)
@pytest.mark.parametrize("stretch", [0.8, 1.1, 1.42])
def test_a_mean_volume_that_has_grown_e_fold_resists_no_more(body, make, stretch):
    """Then a group's own stiffness is negative, and its row has the other sign."""
    u = (stretch - 1) * body.mesh.points
    data = values(body, u)
    signs = np.sign(data[body.pattern.indptr[body.pattern.n_unknowns : -1]])
    assert (signs == (1 if stretch**3 > np.e else -1)).all()
    stable = np.linalg.eigvalsh(condensed(body.pattern, data))[0] > 0
    assert make(body.pattern).factorize(data) == stable


def test_a_body_that_floats_is_no_stable_one(body):
    """Six eigenvalues are zero: neither positive nor to be told from it."""
    nothing = np.empty(0, dtype=np.int64)
    pattern = body.pattern_holding(nothing)
    data, _ = assemble_tangent(body.elements, pattern, np.zeros_like(body.mesh.points))
    assert not make_linear_solver(pattern).factorize(data)


def test_only_neighbours_are_coupled(body, block):
    """A row of a group has the points of its cells, and no pressure but its own."""
    pattern, n = body.pattern, body.pattern.n_unknowns
    linear = Body(block, MATERIALS).pattern
    averaging = body.elements.averaging
    n_free = np.count_nonzero(pattern.row[averaging.points] >= 0)
    n_groups = len(averaging.volumes)
    assert len(pattern.indices) == len(linear.indices) + 3 * n_free + n_groups
    row = np.repeat(np.arange(len(pattern.indptr) - 1), np.diff(pattern.indptr))
    moves = (row < n) & (pattern.indices < n)
    np.testing.assert_array_equal(pattern.indices[moves], linear.indices)
    pairs = np.stack([pattern.indices[~moves] - n, row[~moves] // 3])
    for group, point in pairs[:, row[~moves] < n].T[:200]:
        cells = block.cells[(averaging.groups == group).any(axis=1)]
        assert pattern.free[point] in cells

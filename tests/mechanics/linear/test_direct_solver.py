"""Both linear solvers answer alike, in both precisions, and say when they can't."""

import numpy as np
import pytest
import scipy.sparse as sp

from physgnn.errors import InputError
from physgnn.mechanics import NeoHookean, RestState
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent, make_pattern
from physgnn.mechanics.elements.tet4 import make_elements
from physgnn.mechanics.linear.direct_solver import (
    _FACTORISATION,
    PardisoSolver,
    SuperLUSolver,
    make_linear_solver,
)

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}


@pytest.fixture(scope="module")
def system(block):
    pattern = make_pattern(block.cells, block.n_points, block.point_set("fixed"))
    elements = make_elements(block, MATERIALS)
    data, _ = assemble_tangent(elements, pattern, np.zeros_like(block.points))
    upper = sp.csr_matrix((data, pattern.indices, pattern.indptr))
    return pattern, data, (upper + sp.triu(upper, 1).T).toarray()


@pytest.mark.parametrize(
    ("make", "tolerance"),
    [
        (lambda p: make_linear_solver(p), 1e-10),
        (lambda p: make_linear_solver(p, threads=2), 1e-10),
        (lambda p: make_linear_solver(p, precision="single"), 1e-3),
        (SuperLUSolver, 1e-10),
    ],
)
def test_solvers_agree_with_dense_algebra(system, make, tolerance):
    pattern, data, dense = system
    solver = make(pattern)
    assert solver.factorize(data)
    right = np.random.default_rng(0).standard_normal((5, pattern.n_unknowns))
    expected = np.linalg.solve(dense, right.T).T
    scale = np.abs(expected).max()
    np.testing.assert_allclose(solver.solve(right), expected, atol=tolerance * scale)
    one = solver.solve(right[0])
    np.testing.assert_allclose(one, expected[0], atol=tolerance * scale)
    assert solver.factorize(2 * data), "the analysis serves again"
    half = solver.solve(right[0])
    np.testing.assert_allclose(half, expected[0] / 2, atol=tolerance * scale)


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("storable", [False, True])
def test_factors_are_two_level_unless_they_are_to_be_stored(system, threads, storable):
    """A setting that was made and then overwritten for one thread, unnoticed."""
    pattern, _, _ = system
    solver = make_linear_solver(pattern, threads=threads, storable=storable)
    if not isinstance(solver, PardisoSolver):
        pytest.skip("a setting of MKL Pardiso")
    assert solver._iparm[_FACTORISATION] == (0 if storable else 1)  # oneMKL reference


@pytest.mark.parametrize("make", [make_linear_solver, SuperLUSolver])
def test_an_indefinite_matrix_is_reported(system, make):
    pattern, data, _ = system
    wrong = data.copy()
    wrong[pattern.indptr[30]] *= -1
    assert not make(pattern).factorize(wrong)


def test_rest_state_solves_many_cases_at_once_and_holds_the_fixed(block):
    rest = RestState(Body(block, MATERIALS, "fixed"))
    forces = np.random.default_rng(0).standard_normal((4, block.n_points, 3)) * 1e-4
    together = rest.solve(forces)
    assert not together[:, block.point_set("fixed")].any()
    for case, answer in zip(forces, together, strict=True):
        np.testing.assert_allclose(rest.solve(case), answer, atol=1e-12)
    np.testing.assert_allclose(
        rest.solve(2 * forces[0] - forces[1]), 2 * together[0] - together[1], atol=1e-11
    )


def test_a_body_that_floats_is_refused(block):
    with pytest.raises(InputError, match="at least three points must be fixed"):
        RestState(Body(block, MATERIALS, np.array([0, 1])))
    with pytest.raises(InputError, match="no point set 'skull'"):
        RestState(Body(block, MATERIALS, "skull"))
    with pytest.raises(InputError, match="must index"):
        RestState(Body(block, MATERIALS, np.array([0, 1, 10_000])))


def test_the_same_matrix_is_factorised_once(system, monkeypatch):
    """Paths from rest share the first factor; one that failed is none to share."""
    pattern, data, _ = system
    solver = make_linear_solver(pattern, precision="single")
    if not isinstance(solver, PardisoSolver):
        pytest.skip("SuperLU keeps no matrix to compare with")
    phases: list[int] = []
    call = solver._call
    monkeypatch.setattr(
        solver, "_call", lambda p, *rest: phases.append(p) or call(p, *rest)
    )
    assert solver.factorize(data)
    made = list(phases)
    assert solver.factorize(data.copy())
    assert phases == made
    assert solver.factorize(2 * data)
    assert not solver.factorize(-data)
    assert not solver.factorize(-data), "no factor came of it the first time"
    assert phases.count(made[-1]) == 4

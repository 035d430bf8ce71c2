"""Right-hand sides solved together have bits that do not depend on their company."""

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.mechanics import NeoHookean
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent
from physgnn.mechanics.linear.direct_solver import SuperLUSolver, factorized
from physgnn.mechanics.linear.right_sides import WIDTH, solve_each

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}


@pytest.fixture(scope="module")
def body():
    return Body(block_mesh(12, jitter=0.2), MATERIALS)


def factor_of(body, precision):
    factor = factorized(body, np.zeros_like(body.mesh.points), precision=precision)
    assert factor is not None
    return factor


@pytest.mark.parametrize("precision", ["single", "double"])
def test_each_is_solved_as_if_alone(body, precision):
    """Whatever their number, the others' sizes, and the place among them."""
    rng = np.random.default_rng(0)
    factor = factor_of(body, precision)
    n = body.pattern.n_unknowns
    right = rng.standard_normal(n)
    (alone,) = solve_each(factor, [right])
    near = factor.solve(right)
    within = 1e-4 if precision == "single" else 1e-11
    assert np.linalg.norm(alone - near) < within * np.linalg.norm(near)
    for size in (1, 2, WIDTH, WIDTH + 1, 2 * WIDTH, 2 * WIDTH + 3):
        for place in {0, 1, size // 2, size - 1} & set(range(size)):
            rights = rng.standard_normal((size, n)) * 10 ** rng.uniform(-9, 9)
            rights[rng.random(size) < 0.3] = 0.0
            rights[place] = right
            found = solve_each(factor, list(rights))
            assert len(found) == size
            assert np.array_equal(found[place], alone)


def test_so_it_is_without_mkl(body):
    factor = SuperLUSolver(body.pattern)
    pattern, rng = body.pattern, np.random.default_rng(0)
    data, _ = assemble_tangent(body.elements, pattern, np.zeros_like(body.mesh.points))
    assert factor.factorize(data)
    rights = list(rng.standard_normal((6, pattern.n_unknowns)))
    together = solve_each(factor, rights)
    for right, found in zip(rights, together, strict=True):
        assert np.array_equal(solve_each(factor, [right])[0], found)


def test_none(body):
    assert solve_each(factor_of(body, "single"), []) == []

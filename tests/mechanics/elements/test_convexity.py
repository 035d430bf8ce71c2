"""A tangent without negative parts: the nearest one, and stiffer than the true one."""

import numpy as np
import pytest
from scipy.sparse import csr_array, triu

from meshes import block_mesh
from physgnn.arrays import FloatArray
from physgnn.mechanics import NeoHookean
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.convexity import make_convex
from physgnn.mechanics.elements.tangent import assemble_tangent

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(100.0, 0.1)}


def stiffness(body: Body, u: FloatArray, *, convex: bool) -> FloatArray:
    pattern = body.pattern_holding(body.fixed)
    data, inverted = assemble_tangent(body.elements, pattern, u, convex=convex)
    assert inverted < 0
    n = pattern.n_unknowns
    upper = csr_array((data, pattern.indices, pattern.indptr), shape=(n, n)).copy()
    whole: FloatArray = (upper + triu(upper, 1).T).toarray()
    return whole


@pytest.fixture
def body() -> Body:
    return Body(block_mesh(2, side=20.0, jitter=0.1), MATERIALS)


def test_only_negative_eigenvalues_are_taken_out() -> None:
    rng = np.random.default_rng(0)
    M = rng.normal(size=(9, 9))
    A = (M + M.T).reshape(3, 3, 3, 3).copy()
    values, vectors = np.linalg.eigh(A.reshape(9, 9))
    make_convex(A)
    wanted = (vectors * np.maximum(values, 0.0)) @ vectors.T
    np.testing.assert_allclose(A.reshape(9, 9), wanted, atol=1e-12)


def test_at_rest_it_is_the_tangent(body: Body) -> None:
    rest = np.zeros_like(body.mesh.points)
    true, convex = (stiffness(body, rest, convex=c) for c in (False, True))
    np.testing.assert_allclose(convex, true, atol=1e-12 * np.abs(true).max())


def test_where_the_tangent_is_unstable_it_is_stable_and_stiffer(body: Body) -> None:
    """Squeezed by a tenth, nearly incompressible cells are under high pressure."""
    u = body.mesh.points * np.array([-0.1, -0.1, -0.1])
    true, convex = (stiffness(body, u, convex=c) for c in (False, True))
    assert np.linalg.eigvalsh(true)[0] < 0
    assert np.linalg.eigvalsh(convex)[0] > 0
    more = np.linalg.eigvalsh(convex - true)
    assert more[0] > -1e-9 * more[-1]

"""A body's linear answer, and where a large one's factor is kept."""

import numpy as np
import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import NeoHookean, RestState
from physgnn.mechanics.body import Body
from physgnn.mechanics.linear import linear_elasticity as rest_state
from physgnn.mechanics.linear.direct_solver import FACTOR_FILE, PardisoSolver
from physgnn.mechanics.linear.factor_cache import FACTORS

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}


@pytest.mark.parametrize("large", [False, True])
def test_only_a_large_bodys_factor_is_kept(
    block: TetMesh, tmp_path, monkeypatch, large
):
    monkeypatch.setattr(rest_state, "LARGE", block.n_points + (not large))
    beside = (tmp_path / "block.vtu").with_suffix(FACTORS)
    body = Body(block, MATERIALS, block.point_set("fixed"), factors=beside)
    force = np.random.default_rng(0).standard_normal(block.points.shape)
    expected = RestState(Body(block, MATERIALS)).solve(force)
    for _ in range(2):  # made, then read
        found = RestState(body).solve(force)
        np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())
    if not isinstance(RestState(body)._solver, PardisoSolver):
        pytest.skip("only MKL Pardiso writes its factors")
    assert len(list(beside.glob(f"*/{FACTOR_FILE}"))) == large

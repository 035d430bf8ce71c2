"""A kept factor gives the same bits, and never serves another matrix."""

import numpy as np
import pytest

from physgnn.mechanics import NeoHookean, RestState
from physgnn.mechanics.assembly import make_pattern
from physgnn.mechanics.linear_solver import PardisoSolver, make_linear_solver

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}


@pytest.fixture
def force(block):
    return np.random.default_rng(0).standard_normal(block.points.shape)


@pytest.fixture(autouse=True)
def _needs_pardiso(block):
    pattern = make_pattern(block.cells, block.n_points, block.point_set("fixed"))
    if not isinstance(make_linear_solver(pattern), PardisoSolver):
        pytest.skip("only MKL Pardiso writes its factors")


def test_a_kept_factor_gives_the_same_bits(block, force, tmp_path, monkeypatch):
    first = RestState(block, MATERIALS, cache=tmp_path).solve(force)

    def refuse(*_):
        raise AssertionError("factorised again")

    monkeypatch.setattr(PardisoSolver, "factorize", refuse)
    again = RestState(block, MATERIALS, cache=tmp_path).solve(force)
    np.testing.assert_array_equal(again, first)


def test_another_matrix_has_another_factor(block, force, tmp_path):
    RestState(block, MATERIALS, cache=tmp_path)
    softer = {0: NeoHookean(2000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
    cached = RestState(block, softer, cache=tmp_path).solve(force)
    np.testing.assert_array_equal(cached, RestState(block, softer).solve(force))
    assert len(list(tmp_path.iterdir())) == 2


def test_a_damaged_factor_is_made_again(block, force, tmp_path):
    first = RestState(block, MATERIALS, cache=tmp_path).solve(force)
    (kept,) = tmp_path.iterdir()
    (kept / "handle.pds").unlink()
    again = RestState(block, MATERIALS, cache=tmp_path).solve(force)
    np.testing.assert_array_equal(again, first)
    assert (kept / "handle.pds").exists()

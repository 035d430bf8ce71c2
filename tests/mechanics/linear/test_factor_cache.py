"""A kept factor gives the same bits, and never serves another matrix."""

import shutil

import numpy as np
import pytest

from physgnn.mechanics import NeoHookean, RestState
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent, make_pattern
from physgnn.mechanics.elements.tet4 import ELEMENTS, make_elements
from physgnn.mechanics.linear.direct_solver import (
    FACTOR_FILE,
    PardisoSolver,
    make_linear_solver,
)
from physgnn.mechanics.linear.factor_cache import MAX_BYTES, factorize_cached

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}


@pytest.fixture
def force(block):
    return np.random.default_rng(0).standard_normal(block.points.shape)


@pytest.fixture(autouse=True)
def _needs_pardiso(block):
    pattern = make_pattern(block.cells, block.n_points, block.point_set("fixed"))
    if not isinstance(make_linear_solver(pattern), PardisoSolver):
        pytest.skip("only MKL Pardiso writes its factors")


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("element", ELEMENTS)
def test_a_kept_factor_gives_the_same_bits(
    block, force, tmp_path, monkeypatch, threads, element
):
    """MKL's two-level factors can't be written: trying to kills the process."""
    body = Body(block, MATERIALS, element=element)
    first = RestState(body, threads=threads, cache=tmp_path).solve(force)

    def refuse(*_):
        raise AssertionError("factorised again")

    monkeypatch.setattr(PardisoSolver, "factorize", refuse)
    again = RestState(body, threads=threads, cache=tmp_path).solve(force)
    np.testing.assert_array_equal(again, first)


def test_another_matrix_has_another_factor(block, force, tmp_path_factory):
    tmp_path, other = (tmp_path_factory.mktemp("factors") for _ in range(2))
    RestState(Body(block, MATERIALS), cache=tmp_path)
    softer = {0: NeoHookean(2000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
    cached = RestState(Body(block, softer), cache=tmp_path).solve(force)
    alone = RestState(Body(block, softer), cache=other).solve(force)
    np.testing.assert_array_equal(cached, alone)
    assert len(list(tmp_path.iterdir())) == 2


def test_a_damaged_factor_is_made_again(block, force, tmp_path):
    first = RestState(Body(block, MATERIALS), cache=tmp_path).solve(force)
    (kept,) = tmp_path.iterdir()
    factor = kept / FACTOR_FILE
    whole = factor.read_bytes()
    for damage in (b"", whole[:-1000], whole[:5000] + b"\x55" + whole[5001:]):
        factor.write_bytes(damage)
        again = RestState(Body(block, MATERIALS), cache=tmp_path).solve(force)
        np.testing.assert_array_equal(again, first)
        assert factor.read_bytes() != damage


def test_another_matrix_s_factor_under_its_name_is_made_again(
    block, force, tmp_path_factory
):
    """Checksums and all: they tell whether a file is whole, not whose it is."""
    own, other = (tmp_path_factory.mktemp("factors") for _ in range(2))
    first = RestState(Body(block, MATERIALS), cache=own).solve(force)
    softer = {0: NeoHookean(2000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
    RestState(Body(block, softer), cache=other)
    (kept,), (foreign,) = own.iterdir(), other.iterdir()
    shutil.copytree(foreign, kept, dirs_exist_ok=True)
    again = RestState(Body(block, MATERIALS), cache=own).solve(force)
    np.testing.assert_array_equal(again, first)


def test_a_folder_that_cannot_be_written_does_no_harm(block, force, tmp_path):
    no_folder = tmp_path / "file"
    no_folder.write_text("in the way")
    answer = RestState(Body(block, MATERIALS), cache=no_folder).solve(force)
    expected = RestState(Body(block, MATERIALS), cache=tmp_path / "folder").solve(force)
    np.testing.assert_array_equal(answer, expected)


def test_a_factor_that_cannot_be_written_is_made_all_the_same(block, tmp_path):
    body = Body(block, MATERIALS)
    rest = np.zeros_like(block.points)
    data, _ = assemble_tangent(body.elements, body.pattern, rest)
    solver = make_linear_solver(body.pattern)
    assert factorize_cached(solver, body.pattern, data, tmp_path)
    assert not list(tmp_path.iterdir())


def test_the_factor_not_used_for_longest_goes_first(block, tmp_path):
    def keep(young: float, max_bytes: int = MAX_BYTES) -> set[str]:
        elements = make_elements(block, dict.fromkeys((0, 1), NeoHookean(young, 0.3)))
        pattern = make_pattern(block.cells, block.n_points, block.point_set("fixed"))
        data, _ = assemble_tangent(elements, pattern, np.zeros_like(block.points))
        solver = make_linear_solver(pattern, storable=True)
        factorize_cached(solver, pattern, data, tmp_path, max_bytes=max_bytes)
        return {kept.name for kept in tmp_path.iterdir()}

    one = keep(1000.0)
    (size,) = (file.stat().st_size for file in tmp_path.glob(f"*/{FACTOR_FILE}"))
    two = keep(2000.0)
    assert one < two
    assert keep(1000.0) == two, "the first is read, and is the last used now"
    three = keep(3000.0, max_bytes=5 * size // 2)
    assert len(three) == 2
    assert one < three

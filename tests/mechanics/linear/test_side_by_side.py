"""Paths side by side: solved together, each its own; they end, whatever happens."""

import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from physgnn.mechanics.linear.right_sides import WIDTH
from physgnn.mechanics.linear.side_by_side import (
    Company,
    PathFactor,
    SharedFactor,
    StoppedError,
)

AT_REST, LATER = np.ones(5), np.full(5, 2.0)
N_PATHS, N_SOLVES = 4, 6


class Diagonal:
    """A diagonal matrix; notes how many right-hand sides it was asked for at once."""

    def __init__(self) -> None:
        self.widths, self.factorised = list[int](), 0
        self._data = np.zeros(0)

    def factorize(self, data):
        self.factorised += 1
        time.sleep(0.1)  # so that others begin meanwhile
        self._data = data
        return bool((data > 0).all())

    def solve(self, right):
        self.widths.append(1 if right.ndim == 1 else len(right))
        if np.isnan(right).any():
            raise MemoryError("no room")
        return right / self._data


def walk_all(company, walk, n=N_PATHS):
    """Let n paths begin at the same time and return what becomes of each."""
    shared, spare = SharedFactor(Diagonal()), Diagonal()

    def one(i):
        with company.walk():
            return walk(i, PathFactor(company, shared, spare))

    with ThreadPoolExecutor(n) as threads:
        futures = [threads.submit(one, i) for i in range(n)]
    return futures, shared.solver, spare


def solves(i, factor):
    assert factor.factorize(AT_REST)
    return [factor.solve(np.full(5, 10.0 * i + k)) for k in range(N_SOLVES)]


def test_the_shared_factor_is_made_once_and_solves_for_all():
    futures, shared, spare = walk_all(Company(), solves)
    for i, future in enumerate(futures):
        for k, found in enumerate(future.result()):
            np.testing.assert_array_equal(found, 10.0 * i + k)
    assert (shared.factorised, spare.factorised) == (1, 0)
    assert set(shared.widths) == {WIDTH}
    assert N_SOLVES <= len(shared.widths) < N_PATHS * N_SOLVES


def test_a_path_of_another_tangent_has_the_spare_to_itself():
    def walk(i, factor):
        found = solves(i, factor)
        assert factor.factorize(LATER + i)
        found.extend(factor.solve(LATER + i) for _ in range(N_SOLVES))
        assert factor.factorize(AT_REST)
        found.append(factor.solve(AT_REST))
        return found

    futures, shared, spare = walk_all(Company(), walk)
    for future in futures:
        for found in future.result()[N_SOLVES:]:
            np.testing.assert_array_equal(found, 1.0)
    assert (shared.factorised, spare.factorised) == (1, 2 * N_PATHS)
    assert set(spare.widths) == {1}


def test_paths_that_begin_otherwise_are_solved_as_if_they_shared():
    """Else what comes of a path would depend on which begins first."""

    def walk(i, factor):
        assert factor.factorize(AT_REST + i)
        return factor.solve(AT_REST + i)

    futures, shared, spare = walk_all(Company(), walk)
    for future in futures:
        np.testing.assert_array_equal(future.result(), 1.0)
    assert (shared.factorised, spare.factorised) == (1, N_PATHS - 1)
    assert set(spare.widths) == set(shared.widths) == {WIDTH}


def test_a_path_that_fails_leaves_the_others_walking():
    def walk(i, factor):
        found = solves(i, factor)
        if i == 1:
            raise ValueError("a bug")
        return [*found, factor.solve(AT_REST)]

    futures, *_ = walk_all(Company(), walk)
    assert [type(f.exception()) for f in futures].count(type(None)) == N_PATHS - 1
    assert isinstance(futures[1].exception(), ValueError)


def test_what_the_solver_raises_reaches_the_paths():
    def walk(_, factor):
        factor.factorize(AT_REST)
        return factor.solve(np.full(5, np.nan))

    futures, *_ = walk_all(Company(), walk)
    assert all(isinstance(f.exception(), MemoryError) for f in futures)


def test_a_tangent_at_rest_that_is_not_positive_is_refused_to_all():
    futures, *_ = walk_all(Company(), lambda _, factor: factor.factorize(-AT_REST))
    assert [f.result() for f in futures] == [False] * N_PATHS


def test_stopped():
    company = Company()

    def walk(i, factor):
        found = solves(i, factor)
        company.stop()
        return [*found, factor.solve(AT_REST)]

    futures, *_ = walk_all(company, walk)
    assert all(isinstance(f.exception(), StoppedError) for f in futures)


@pytest.mark.parametrize("n", [1, 11])
def test_waiting_for_others_is_no_time_of_a_paths_own(n):
    """However many there are: what each took adds up to no more than has passed."""

    def walk(i, factor):
        started = time.perf_counter()
        solves(i, factor)
        return time.perf_counter() - started - factor.waited

    started = time.perf_counter()
    futures, *_ = walk_all(Company(), walk, n)
    own = [future.result() for future in futures]
    assert min(own) > 0.0
    assert sum(own) < 1.1 * (time.perf_counter() - started)

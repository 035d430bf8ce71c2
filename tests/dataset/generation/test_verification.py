"""A sample of levels is checked once, whoever solved them, and changes no hash."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from physgnn.dataset import Store, generate, verification_of, verify
from physgnn.dataset.generation.verification import EVERY, draw_level
from physgnn.dataset.storage import layout
from physgnn.mechanics.equilibrium.full_newton import Newton
from physgnn.mechanics.equilibrium.solution import Solution, Status

NewStore = Callable[..., Store]


def test_solved_levels_are_where_newton_has_them(new_store: NewStore) -> None:
    store = new_store(n_paths=2 * EVERY + 1)
    generate(store)
    before, told = store.content_hash(), []
    found = verify(store, progress=lambda *step: told.append(step))
    assert found.samples[:, 0].tolist() == [0, EVERY, 2 * EVERY]
    assert found.samples[:, 1].tolist() == [draw_level(store, i) for i in (0, 5, 10)]
    assert (found.distance_mm < 1e-4).all()
    assert [step[:2] for step in told] == [(1, 3), (2, 3), (3, 3)]
    assert str(found).startswith("checked 3 of 33 levels against full Newton: largest")
    assert store.content_hash() == before
    again = verification_of(Store.open(store.path))
    assert np.array_equal(again.samples, found.samples)
    assert np.array_equal(again.distance_mm, found.distance_mm)


def test_a_wrong_level_is_found(new_store: NewStore, made_up: Callable[..., Solution]):
    """A shift of every free point by d mm shows as a distance of d."""
    store, shift = new_store(n_paths=1), np.array([0.0, 0.03, 0.04])
    newton = Newton(store.body)
    exact = np.zeros((store.n_levels, store.mesh.n_points, 3))
    for level in range(store.n_levels):
        start = exact[max(level - 1, 0)]
        solved = newton.solve(store.load_case(0, level), start)
        assert solved is not None
        exact[level] = solved
    free = np.setdiff1d(np.arange(store.mesh.n_points), store.fixed)
    exact[:, free] += shift
    store.write(0, replace_displacement(made_up(store, 0), exact))
    assert verify(store).largest_mm == pytest.approx(0.05, rel=1e-4)


def replace_displacement(solution: Solution, displacement: np.ndarray) -> Solution:
    values = {**vars(solution), "displacement": displacement}
    return Solution(**values)


def test_what_was_checked_is_not_checked_again(
    new_store: NewStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    store, checked = new_store(n_paths=EVERY + 1), []
    generate(store)

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        verify(store, progress=interrupt)
    assert verification_of(store).samples[:, 0].tolist() == [0]
    distance = Newton.distance
    monkeypatch.setattr(
        Newton, "distance", lambda *a: (checked.append(1), distance(*a))[1]
    )
    assert verify(store).samples[:, 0].tolist() == [0, EVERY]
    assert len(checked) == 1
    verify(store)
    assert len(checked) == 1


def test_only_converged_levels(
    new_store: NewStore, made_up: Callable[..., Solution]
) -> None:
    store = new_store(n_paths=2)
    assert str(verify(store)) == "checked none of 0 levels against full Newton"
    failed = made_up(store, 0, message="stopped")
    failed.status[:] = Status.NOT_REACHED
    failed.status[1] = Status.CONVERGED
    store.write(0, failed)
    assert draw_level(store, 0) == 1


@pytest.mark.parametrize("survived", range(9))
def test_a_kill_between_two_arrays_is_resumed(
    new_store: NewStore, monkeypatch: pytest.MonkeyPatch, survived: int
) -> None:
    """Three arrays are made, then two paths' rows are written into each."""
    store, written = new_store(n_paths=EVERY + 1), []
    generate(store)
    with monkeypatch.context() as killed:
        for name in ("put_rows", "write_row"):
            original = getattr(layout, name)

            def write(*given: Any, original: Callable[..., None] = original) -> None:
                if len(written) == survived:
                    raise KeyboardInterrupt
                written.append(given[1])
                original(*given)

            killed.setattr(layout, name, write)
        with pytest.raises(KeyboardInterrupt):
            verify(store)
    assert len(written) == survived
    resumed = verify(Store.open(store.path))
    assert resumed.samples[:, 0].tolist() == [0, EVERY]
    assert resumed.largest_mm < 1e-4

"""Labels of our own solver are equilibria; those of another method are not."""

from collections.abc import Callable

import numpy as np

from physgnn.dataset import Store, generate
from physgnn.dataset.label_balance import in_balance
from physgnn.mechanics.equilibrium.solution import Solution


def test_what_is_solved_is_in_balance(new_store: Callable[..., Store]) -> None:
    store = new_store(n_paths=2, force_n=1e-2)
    generate(store, workers=1)
    assert in_balance(store)


def test_displacements_from_elsewhere_are_not(
    new_store: Callable[..., Store], made_up: Callable[..., Solution]
) -> None:
    solved, other = new_store("a.zarr", 2, force_n=1e-2), new_store("b.zarr", 2)
    generate(solved, workers=1)
    made = made_up(other, 0)
    too_far = solved.displacement(0).astype(np.float64) * 1.1
    other.write(0, Solution(**{**vars(made), "displacement": too_far}))
    assert not in_balance(other)


def test_the_last_level_that_converged_counts(
    new_store: Callable[..., Store], made_up: Callable[..., Solution]
) -> None:
    store = new_store(n_paths=1, force_n=1e-2)
    solved = new_store("a.zarr", 1, force_n=1e-2)
    generate(solved, workers=1)
    part = solved.displacement(0).astype(np.float64)
    part[-1] = 0.0
    stopped = vars(made_up(store, 0, message="a limit point"))
    store.write(0, Solution(**{**stopped, "displacement": part}))
    assert in_balance(store)


def test_a_pending_dataset_says_nothing_against_it(
    new_store: Callable[..., Store],
) -> None:
    assert in_balance(new_store())

"""What was used recently is kept up to a number of bytes."""

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.mechanics.reduced.expansions.recently_used import VARIABLE, RecentlyUsed


def squares(limit: int | None = None) -> tuple[RecentlyUsed[int, int], list[int]]:
    """Squares of numbers, each of its own number of bytes, and which were made."""
    made: list[int] = []

    def make(number: int) -> int:
        made.append(number)
        return number**2

    return RecentlyUsed(make, lambda square: round(square**0.5), limit), made


def test_the_ones_used_least_recently_go() -> None:
    kept, made = squares(limit=6)
    assert [kept(number) for number in (1, 2, 3, 1)] == [1, 4, 9, 1]
    assert kept.n_bytes == 6
    kept(2)
    kept(1)
    kept(3)
    assert made == [1, 2, 3]
    kept(4)  # leaves room for nothing but the 1 beside it, and 3 was used later
    assert made == [1, 2, 3, 4]
    assert (len(kept), kept.n_bytes) == (1, 4)


@pytest.mark.parametrize("seed", range(5))
def test_never_more_than_the_limit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    kept, _ = squares(limit=20)
    for number in rng.integers(1, 15, size=200).tolist():
        assert kept(number) == number**2
        assert kept.n_bytes <= 20


def test_what_was_asked_for_last_is_kept_even_if_it_is_larger() -> None:
    kept, made = squares(limit=5)
    assert kept(9) == kept(9) == 81
    assert made == [9]


def test_nothing_is_left_after_clearing() -> None:
    kept, made = squares(limit=5)
    kept(2)
    kept.clear()
    assert (len(kept), kept.n_bytes) == (0, 0)
    kept(2)
    assert made == [2, 2]


def test_the_user_sets_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "3e-9")
    kept, _ = squares()
    kept(1)
    kept(2)
    kept(3)
    assert kept.n_bytes == 3


@pytest.mark.parametrize("value", ["much", "0", "-1", "inf", "nan"])
def test_a_limit_is_a_number_of_gigabytes(
    monkeypatch: pytest.MonkeyPatch, value: str
) -> None:
    monkeypatch.setenv(VARIABLE, value)
    with pytest.raises(InputError, match=f"{VARIABLE} must be a number"):
        squares()

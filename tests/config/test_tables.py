"""Keys and types of a table are checked; the message says what was expected and got."""

from dataclasses import dataclass

import pytest

from physgnn.config.tables import read_as, table_of, variants
from physgnn.errors import InputError


@dataclass(frozen=True)
class Mixed:
    name: str
    size: float = 1.0
    limit: int | None = None
    place: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if self.size < 0:
            raise InputError(f"size must be ≥ 0 (got {self.size})")


@dataclass(frozen=True)
class Bare:
    flag: bool = False


MIXED = table_of(Mixed)


def test_a_dataclass_is_made_of_its_table() -> None:
    assert read_as(MIXED, {"name": "a", "size": 2}, "here") == Mixed("a", 2)
    assert read_as(MIXED, {"name": "a", "limit": None}, "here").limit is None
    assert read_as(MIXED, {"name": "a", "place": [1, 2.5]}, "here").place == (1, 2.5)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"name": 1}, r"name in here must be str \(got 1\)"),
        ({"name": "a", "limit": 0.5}, r"limit in here must be int \(got 0.5\)"),
        ({"name": "a", "limit": True}, r"limit in here must be int \(got True\)"),
        ({"name": "a", "size": "b"}, r"size in here must be float \(got 'b'\)"),
        ({"name": "a", "size": -1}, r"here: size must be ≥ 0 \(got -1"),
        (
            {"name": "a", "place": [1]},
            r"place in here must be a list of 2 numbers \(got \[1\]\)",
        ),
        ({"size": 1.0}, "here needs the key 'name'"),
        (
            {"name": "a", "limits": 1},
            r"unknown key 'limits' in here, did you mean 'limit'\? \(its keys: name, ",
        ),
        ({"name": "a", "colour": 1}, r"unknown key 'colour' in here \(its keys: name"),
        ([1, 2], r"here must be a table \(got \[1, 2\]\)"),
    ],
)
def test_mistakes(table: object, message: str) -> None:
    with pytest.raises(InputError, match=message) as raised:
        read_as(MIXED, table, "here")
    assert "\n" not in str(raised.value)


def test_a_key_chooses_among_rows_and_mistakes_are_placed() -> None:
    kind = dict[str, tuple[variants("kind", {"mixed": Mixed, "bare": Bare}), ...]]  # type: ignore[misc]
    found = read_as(
        kind, {"a": [{"kind": "bare"}, {"kind": "mixed", "name": "n"}]}, "f"
    )
    assert found == {"a": (Bare(), Mixed("n"))}
    for table, message in (
        ({"kind": "cube"}, r"\[\[a\]\] number 1 in f needs kind = one of mixed, bare"),
        ({"flag": True}, r"needs kind = one of mixed, bare"),
        ({"kind": "bare", "flag": 1}, r"flag in \[\[a\]\] number 1 in f must be bool"),
    ):
        with pytest.raises(InputError, match=message):
            read_as(kind, {"a": [table]}, "f")

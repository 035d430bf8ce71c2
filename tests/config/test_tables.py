"""Keys and types of a table are checked."""

from dataclasses import dataclass

import pytest

from physgnn.config import from_table
from physgnn.errors import InputError


@dataclass(frozen=True)
class Mixed:
    name: str
    size: float = 1.0
    limit: int | None = None


def test_from_table_checks_types() -> None:
    assert from_table(Mixed, {"name": "a", "size": 2}, "here") == Mixed("a", 2)
    assert from_table(Mixed, {"name": "a", "limit": None}, "here").limit is None
    for table in ({"name": 1}, {"name": "a", "limit": 0.5}, {"name": "a", "size": "b"}):
        with pytest.raises(InputError, match="in here must be"):
            from_table(Mixed, table, "here")
    with pytest.raises(InputError, match="here must be a table"):
        from_table(Mixed, [1, 2], "here")

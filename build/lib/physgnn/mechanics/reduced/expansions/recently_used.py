"""What was used recently is kept, up to a number of bytes.

What a model makes when it is first needed, such as the factor of a state, grows with
the mesh: a number of them bounds no memory, a number of bytes does. Who has more
memory, and a mesh that needs it, sets the environment variable ``PHYSGNN_CACHE_GB``.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

from physgnn.memory_limits import GB, gigabytes

VARIABLE = "PHYSGNN_CACHE_GB"
LIMIT_GB = 2.0  # of each model: seven states of a brain of 10,000 points take 0.9

Key = TypeVar("Key", bound=Hashable)
Value = TypeVar("Value")


class RecentlyUsed(Generic[Key, Value]):
    """Makes values when they are asked for, and keeps those used most recently.

    Parameters
    ----------
    make : callable
        From a key to its value.
    n_bytes : callable
        What a value takes.
    limit : int, optional
        Bytes that may be kept; by default what ``PHYSGNN_CACHE_GB`` says. The value
        asked for last is kept even if it takes more.

    Raises
    ------
    InputError
        If the environment variable is no number > 0.
    """

    def __init__(
        self,
        make: Callable[[Key], Value],
        n_bytes: Callable[[Value], int],
        limit: int | None = None,
    ) -> None:
        self._make, self._size_of = make, n_bytes
        self._limit = (
            int(gigabytes(VARIABLE, LIMIT_GB) * GB) if limit is None else limit
        )
        self._kept: OrderedDict[Key, Value] = OrderedDict()
        self.n_bytes = 0

    def __call__(self, key: Key) -> Value:
        """Return the value of a key."""
        if key not in self._kept:
            value = self._make(key)
            self._kept[key] = value
            self.n_bytes += self._size_of(value)
            self._drop_oldest()
        self._kept.move_to_end(key)
        return self._kept[key]

    def __len__(self) -> int:
        return len(self._kept)

    def clear(self) -> None:
        """Drop everything."""
        self._kept.clear()
        self.n_bytes = 0

    def _drop_oldest(self) -> None:
        while self.n_bytes > self._limit and len(self._kept) > 1:
            _, dropped = self._kept.popitem(last=False)
            self.n_bytes -= self._size_of(dropped)

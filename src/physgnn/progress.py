"""How long functions tell a caller how far they are, and what they found on the way."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

Progress = Callable[[int, int, str], None]
"""Called with steps done, steps in all, and what is being done."""
Log = Callable[[str], None]
"""Called with a line about what was done or is there already."""
Show = Callable[[str], AbstractContextManager[Progress]]
"""From the title of a step to a context that yields the step's progress callback."""


def no_log(_: str) -> None:
    """Say nothing: the default of functions that take a `Log`."""


def no_progress(_done: int, _of: int, _what: str) -> None:
    """Show nothing: the default of functions that take a `Progress`."""


@contextmanager
def no_show(_: str) -> Iterator[Progress]:
    """Show nothing: the default of functions that take a `Show`."""
    yield no_progress

"""What a cycle of objects held goes back to the system."""

from typing import Any

import numpy as np
import psutil

from physgnn.freed_memory import give_back

MB = 1e6


class Holder:
    """An array, held in a cycle: no count of references frees it."""

    def __init__(self) -> None:
        self.array = np.ones(10_000_000)  # 80 MB
        self.itself: Any = self


def test_what_a_cycle_held_goes_back() -> None:
    resident = psutil.Process().memory_info
    give_back()
    before = resident().rss
    holder = Holder()
    held = resident().rss - before
    del holder
    give_back()
    left = resident().rss - before
    assert held > 60 * MB
    assert left < 20 * MB

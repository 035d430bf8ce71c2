"""What every backend offers."""

from collections.abc import Callable
from dataclasses import dataclass

from physgnn.arrays import BoolArray
from physgnn.geometry.image import Image


@dataclass(frozen=True)
class Backend:
    """One way to find the brain.

    Attributes
    ----------
    contrasts : frozenset of str
        The scans it serves.
    available : callable
        Whether it is installed.
    brain : callable
        From an upright image of cubes to the brain's mask on its voxels.
    install : str
        What to do if it is not.
    """

    contrasts: frozenset[str]
    available: Callable[[], bool]
    brain: Callable[[Image], BoolArray]
    install: str

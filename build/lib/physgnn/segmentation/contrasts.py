"""The kinds of MR scan, and what fluid looks like in them."""

from collections.abc import Mapping

FLUID_IS_BRIGHT: Mapping[str, bool] = {
    "t1": False,
    "t1c": False,
    "t2": True,
    "flair": False,
}
"""Contrast → whether cerebrospinal fluid is bright; FLAIR attenuates it."""

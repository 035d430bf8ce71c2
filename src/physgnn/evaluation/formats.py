"""Numbers as people read them."""

import numpy as np

NONE = "—"


def mm(value: float) -> str:
    """Return millimetres to three significant digits, at most four decimals."""
    if value == 0 or value >= 100:
        return f"{value:.0f}"
    if value < 5e-5:
        return "< 0.0001"
    decimals = int(np.clip(2 - np.floor(np.log10(abs(value))), 0, 4))
    return f"{value:.{decimals}f}"


def spread(mean: float, std: float) -> str:
    """Return mean ± standard deviation."""
    return f"{mm(mean)} ± {mm(std)}"


def percent(share: float) -> str:
    """Return a share as per cent, its distance from 100 % kept in sight."""
    decimals = 2 if 0.99 < share < 1 else 1
    return f"{100 * share:.{decimals}f} %"


def duration(seconds: float) -> str:
    """Return a time in the unit that suits it."""
    if seconds < 1:
        return f"{1e3 * seconds:.3g} ms"
    return f"{seconds:.3g} s"


def minutes(value: float) -> str:
    """Return minutes of training; nothing where there was next to none."""
    return NONE if value < 0.005 else f"{value:.2g} min"

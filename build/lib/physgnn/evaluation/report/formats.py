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


def percent(fraction: float) -> str:
    """Return a fraction in per cent, with more digits close to 100 %."""
    decimals = 2 if 0.99 < fraction < 1 else 1
    return f"{100 * fraction:.{decimals}f} %"


def with_spread(mean: str, std: float) -> str:
    """Return a written mean with ± a standard deviation of as many decimals.

    Per cent stay per cent: ("77.6 %", 0.002) gives 77.6 ± 0.2 %.
    """
    number, _, unit = mean.partition(" ")
    if not number[0].isdigit():
        return mean  # "< 0.0001": there is no place for a spread
    decimals = len(number.partition(".")[2])
    scaled = 100 * std if unit == "%" else std
    return f"{number} ± {scaled:.{decimals}f} {unit}".rstrip()


def duration(seconds: float) -> str:
    """Return a time in the unit that suits it."""
    if seconds < 1:
        return f"{1e3 * seconds:.3g} ms"
    return f"{seconds:.3g} s"


def minutes(value: float) -> str:
    """Return minutes of training; nothing where there was next to none."""
    return NONE if value < 0.005 else f"{value:.2g} min"

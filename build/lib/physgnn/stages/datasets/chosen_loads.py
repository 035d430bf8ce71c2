"""The loads that a command is given: a preset by name, or a file."""

from pathlib import Path

from physgnn.config import read_preset
from physgnn.dataset import Preset
from physgnn.errors import InputError


def chosen_preset(preset: str | None, loads: str | Path | None) -> str | Preset:
    """Return the one that is given of a preset's name and a TOML file.

    Raises
    ------
    InputError
        If it is none or both, or the file cannot be used.
    """
    if (preset is None) == (loads is None):
        raise InputError("give --preset or --loads")
    return preset if preset is not None else read_preset(str(loads))

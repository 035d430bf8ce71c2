"""What a message says to do can be done by the command that says it."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer

import physgnn
from dicom_files import write_series
from physgnn.cli.app import app
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.io.medical.images.formats import read_image
from physgnn.prediction.evidence import RULES
from physgnn.prediction.status import ARGUMENT, PredictionStatus

GROUP: Any = typer.main.get_command(app)
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z0-9]*(?:-[a-z0-9]+)*")
OF_A_LOAD = {"OUTSIDE_TRAINED_RANGE", "REPAIRED", "SOLVED"}
OF_A_MEASUREMENT = {
    "TOO_FEW_POINTS", "MEASUREMENT_TOO_FAR", "MISFIT_ABOVE_NOISE", "MOVED_AS_A_WHOLE",
    "NAVIGATION_OFFSET", "OFFSET_NOT_TOLD", "TOO_FEW_BONE_POINTS", "BONE_MISFIT",
    "OK_IF_NAVIGATION_IS_RIGHT",
}  # fmt: skip
USABLE = {"OK", "OK_IF_NAVIGATION_IS_RIGHT", "REPAIRED", "SOLVED"}
NEVER = {"predict": OF_A_MEASUREMENT, "register": OF_A_LOAD}
OF_OTHERS = {"--xml", "--returnparameterfile"}  # what 3D Slicer calls
CALLS = {"segmentation/backends/programs.py", "registration/inference/bounds.py"}
"""Modules that name options of other programs."""


def options(command: str) -> set[str]:
    """Return every option of a command."""
    found = {"--help"}
    for parameter in GROUP.commands[command].params:
        found |= {*parameter.opts, *parameter.secondary_opts}
    return found


@pytest.mark.parametrize("command", NEVER)
@pytest.mark.parametrize("status", PredictionStatus)
def test_a_remedy_names_options_that_the_command_has(
    command: str, status: PredictionStatus
) -> None:
    text = status.remedy_for(command)
    assert ARGUMENT.search(text) is None
    if status.name not in NEVER[command]:
        assert set(OPTION.findall(text)) <= options(command), text


def test_which_statuses_a_command_has_is_what_the_rules_say() -> None:
    """A new status has to be sorted in here."""
    known = {status.name for status, _ in RULES} | USABLE
    assert known == {status.name for status in PredictionStatus}
    assert known >= OF_A_LOAD | OF_A_MEASUREMENT
    by_the_load = {s.name for s, rule in RULES if rule.__name__ == "_outside"}
    assert by_the_load == OF_A_LOAD - {"REPAIRED", "SOLVED"}


def test_every_option_that_a_message_names_is_one_of_some_command() -> None:
    known = {option for command in GROUP.commands for option in options(command)}
    known |= {option for parameter in GROUP.params for option in parameter.opts}
    folder = Path(physgnn.__file__).parent
    for file in sorted(folder.rglob("*.py")):
        name = file.relative_to(folder).as_posix()
        named = set(OPTION.findall(file.read_text("utf-8"))) - OF_OTHERS
        assert named <= known or name in CALLS, (name, named - known)


def test_a_series_is_named_by_what_every_command_has(tmp_path: Path) -> None:
    """`segment`, `register`, `predict` and `view` have no --series."""
    image = Image(np.arange(27.0).reshape(3, 3, 3), np.eye(4))
    for uid in ("1.2.3", "1.2.4"):
        write_series(tmp_path / "two", image, uid=uid, prefix=uid)
    with pytest.raises(InputError, match=r"pick one by a path FOLDER/UID, or where a"):
        read_image(tmp_path / "two")
    one = read_image(tmp_path / "two" / "1.2.4")
    assert one.data.shape == (3, 3, 3)

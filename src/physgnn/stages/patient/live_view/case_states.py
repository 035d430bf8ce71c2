"""The states of a brain as the live view hands them over, registered as a series is."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.errors import InputError
from physgnn.io.medical.linear_transforms import ITK_SUFFIXES
from physgnn.io.medical.markups import POINT_READERS
from physgnn.io.surfaces.formats import SURFACE_READERS
from physgnn.stages.patient.intraoperative.measured_files import MeasuredFiles
from physgnn.stages.patient.intraoperative.one_state import HowToRegister
from physgnn.stages.patient.intraoperative.patient_body import PatientBody
from physgnn.stages.patient.intraoperative.state_series import StateSeries
from physgnn.stages.patient.intraoperative.state_table import StateRow

if TYPE_CHECKING:
    from physgnn.serving.patient.desk import MeasuredState, RegisteredShift


@dataclass(frozen=True)
class Role:
    """What a measured file may be.

    Attributes
    ----------
    name : str
        On the page.
    argument : str
        Of `register`.
    """

    name: str
    argument: str


ROLES: Mapping[str, Role] = {
    "pairs": Role("pairs of points", "points"),
    "before": Role("points before", "points"),
    "after": Role("points after", "target"),
    "surface": Role("exposed surface", "surface"),
    "landmarks": Role("pairs inside the brain", "landmarks"),
    "landmarks before": Role("landmarks before", "landmarks"),
    "landmarks after": Role("landmarks after", "landmarks_target"),
    "whole surface": Role("whole surface", "whole_surface"),
    "intraoperative": Role("scan of the operation", "intraoperative"),
    "bone": Role("pairs of bone points", "bone"),
    "bone before": Role("bone points of the scan", "bone"),
    "bone after": Role("bone points now", "bone_target"),
    "initial transform": Role("initial transform", "initial_transform"),
}
SCANS = (".nii.gz", ".nii", ".nrrd", ".mha", ".mgz")  # of one file each
TRANSFORMS = (".txt", *ITK_SUFFIXES)
SUFFIXES = list(dict.fromkeys((*POINT_READERS, *SURFACE_READERS, *SCANS, *TRANSFORMS)))
"""How measured files may end."""

ALONE = "registered"  # name of the only state


def rows_of(states: "Sequence[MeasuredState]") -> list[StateRow]:
    """Return states as of a table, each under a name of its own that suits a file.

    Raises
    ------
    InputError
        If two files of a state are the same argument.
    """
    rows: list[StateRow] = []
    for state in states:
        arguments = {ROLES[role].argument: path for role, path in state.files.items()}
        if len(arguments) < len(state.files):
            roles = ", ".join(ROLES[role].name for role in state.files)
            raise InputError(f"give pairs, or points before and after (got {roles})")
        taken = {row.name.lower() for row in rows}
        name = _free(state.name, taken) if len(states) > 1 else ALONE
        rows.append(StateRow(name, None, MeasuredFiles(**arguments)))
    return rows


def registered(
    patient: PatientBody, rows: Sequence[StateRow], folder: Path, how: HowToRegister
) -> "Iterator[RegisteredShift]":
    """Register states one after the other into a folder that is there.

    Raises
    ------
    InputError
        If what was measured of a state cannot be used.
    """
    from physgnn.serving.patient.desk import RegisteredShift

    said: list[str] = []
    series = StateSeries(patient, folder, how, said.append)
    for row in rows:
        said.clear()
        result = series.result_of(row)
        if series.last is None:
            raise InputError(result.reason)
        yield RegisteredShift(
            found=series.last,
            file=folder / f"{row.name}.vtu",
            misfits=folder / f"{row.name}-misfits.csv",
            notes=tuple(line.removeprefix(f"{row.name}: ") for line in said),
        )


def _free(wanted: str, taken: set[str]) -> str:
    """Return a name that suits a file and is not taken."""
    name = re.sub(r"[^\w .+-]", "-", wanted).strip(" .-+")[:80].rstrip(" .") or "state"
    number, free = 1, name
    while free.lower() in taken:
        number += 1
        free = f"{name} {number}"
    return free

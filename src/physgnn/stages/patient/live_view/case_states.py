"""The states of a brain as the live view hands them over, registered as a series is."""

import re
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.errors import InputError
from physgnn.stages.patient.intraoperative.measured_files import MeasuredFiles
from physgnn.stages.patient.intraoperative.one_state import OUTLIER, HowToRegister
from physgnn.stages.patient.intraoperative.patient_body import PatientBody
from physgnn.stages.patient.intraoperative.scan_surface import ScanOptions
from physgnn.stages.patient.intraoperative.state_series import StateSeries
from physgnn.stages.patient.intraoperative.state_table import StateRow
from physgnn.stages.patient.live_view.page_options import (
    ROLES,
    check_chosen,
    chosen_or_default,
    in_page_words,
)

if TYPE_CHECKING:
    from physgnn.serving.patient.desk import (
        FailedState,
        MeasuredState,
        RegisteredShift,
        RegisterOptions,
    )


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


def how_to_register(
    states: "Sequence[MeasuredState]", options: "RegisterOptions"
) -> HowToRegister:
    """Return what is alike for all states.

    Raises
    ------
    InputError
        If something is chosen that nothing would use.
    """
    check_chosen({role for state in states for role in state.files}, options.chosen)
    contrast, transformed = (
        chosen_or_default(name, options.chosen) for name in ("contrast", "transformed")
    )
    return HowToRegister(
        options.noise_mm,
        rigid_offset=options.rigid_offset,
        transformed=transformed,
        scan=ScanOptions(contrast=contrast),
    )


def registered(
    patient: PatientBody,
    states: "Sequence[MeasuredState]",
    folder: Path,
    how: HowToRegister,
) -> "Iterator[RegisteredShift | FailedState]":
    """Register states one after the other into a folder that is there.

    A state that fails does not stop the others.

    Raises
    ------
    InputError
        If two files of a state are one argument, or the only state cannot be used.
    """
    from physgnn.serving.patient.desk import FailedState, RegisteredShift

    said: list[str] = []
    series = StateSeries(patient, folder, how, said.append)
    rows = rows_of(states)
    for state, row in zip(states, rows, strict=True):
        said.clear()
        named = partial(_named, state=state, folder=folder)
        result = series.result_of(row, named)
        if series.last is not None:
            yield RegisteredShift(
                found=series.last,
                file=folder / f"{row.name}.vtu",
                misfits=folder / f"{row.name}-misfits.csv",
                notes=tuple(
                    _note(line, folder, named)
                    for line in (line.removeprefix(f"{row.name}: ") for line in said)
                    if not line.startswith(OUTLIER)  # misfits say so
                ),
            )
        elif len(rows) > 1:
            yield FailedState(in_page_words(result.reason))
        else:
            raise InputError(in_page_words(result.reason))


def _note(line: str, folder: Path, named: Callable[[str], str]) -> str:
    """Return what was said of a state as the page says it."""
    return in_page_words(named(line.replace(f"{folder}/", "the saved ")))


def _named(text: str, *, state: "MeasuredState", folder: Path) -> str:
    """Return a line with files called what the page calls them."""
    for role, path in state.files.items():
        called = state.called.get(role, path.name)
        text = text.replace(str(path), called).replace(path.name, called)
    return text.replace(f"{folder}/", "")


def _free(wanted: str, taken: set[str]) -> str:
    """Return a name that suits a file and is not taken."""
    name = re.sub(r"[^\w .+-]", "-", wanted).strip(" .-+")[:80].rstrip(" .") or "state"
    number, free = 1, name
    while free.lower() in taken:
        number += 1
        free = f"{name} {number}"
    return free

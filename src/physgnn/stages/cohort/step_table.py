"""What a batch does with a patient: one row a stage, in order.

A stage joins by its row. Its columns are read off its function; see `columns`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from physgnn import stages

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.geometry import TetMesh
    from physgnn.prediction.prediction import Prediction
    from physgnn.registration.result import Registration
    from physgnn.stages.patient.intraoperative.state_series import StateResult
    from physgnn.stages.patient.preoperative.adaptation import Adapted

Figures = dict[str, Any]
"""What the table of results says of a step: column → what JSON can hold."""
STATUS, REASONS = "status", "reasons"
OF_STATE = (
    STATUS, "largest_mm", "bound_mean_mm", "bound_max_mm", "misfit_mm", "held_out_mm",
    "offset_mm", "bone",
)  # fmt: skip
NOT_OK = "not ok"  # a figure: True if a displacement must not be relied on


def _no_figures(_: Any) -> Figures:
    return {}


@dataclass(frozen=True)
class Several:
    """An argument with which a stage makes a folder of results, and resumes it.

    Attributes
    ----------
    argument : str
    folder : str
        Its name.
    last : callable
        From the arguments to the name of the file in it that later steps take.
    """

    argument: str
    folder: str
    last: Callable[[Mapping[str, Any]], str]


@dataclass(frozen=True)
class Step:
    """One stage of a batch.

    Attributes
    ----------
    command : str
        The function of `physgnn.stages`.
    starts : tuple of str
        Its arguments that ask for it: filled in, or there from an earlier step.
    makes, file : str
        What it makes, in the words of `takes`, and the file or folder for it.
    takes : mapping
        Argument → what an earlier step makes for it, unless a column names it.
    defaults : mapping
        Argument → what it is if nothing gives it, where the function has no default.
    of_mesh : str
        An argument that has no default once the patient has a mesh of its own.
    writes : mapping
        Argument → what else it writes, in the patient's folder; no columns.
    figures : callable
        From what the function returns to what the results say.
    several : Several, optional
        What makes it a folder of several, if there is such a thing; nothing else is
        then written.
    """

    command: str
    starts: tuple[str, ...]
    makes: str
    file: str
    takes: Mapping[str, str] = field(default_factory=dict)
    defaults: Mapping[str, Any] = field(default_factory=dict)
    of_mesh: str = ""
    writes: Mapping[str, Any] = field(default_factory=dict)
    figures: Callable[[Any], Figures] = _no_figures
    several: Several | None = None


def _of_mesh(made: "TetMesh") -> Figures:
    return {"points": made.n_points, "cells": made.n_cells}


def _of_adapted(made: "Adapted") -> Figures:
    return {"coverage": made.coverage}


def _of_prediction(made: "Prediction") -> Figures:
    bound = made.error_estimate_mm
    size = (made.displacement**2).sum(axis=1) ** 0.5
    return {
        STATUS: str(made.status),
        REASONS: "; ".join(made.reasons),
        NOT_OK: not made.status.usable,
        "largest_mm": round(float(size.max()), 4),
        "mean_mm": round(float(size.mean()), 4),
        "bound_mean_mm": None if bound is None else round(bound.mean_mm, 4),
        "bound_max_mm": None if bound is None else round(bound.max_mm, 4),
    }


def _of_registration(
    made: "Registration | tuple[StateResult, ...]",
) -> Figures:
    if isinstance(made, tuple):
        return _of_states(made)
    return {
        **_of_prediction(made.prediction),
        "misfit_mm": round(float(made.misfit_mm), 4),
        "held_out_mm": round(float(made.held_out_mm), 4),
        "offset_mm": round(made.offset.length_mm, 4),
        "bone": "" if made.bone is None else str(made.bone),
    }


def _of_states(made: "tuple[StateResult, ...]") -> Figures:
    """Return the figures of a series's last state, and which states are not ok."""
    bad = [one for one in made if one.outcome != "ok"]
    lines = (f"{one.name} {one.outcome}: {one.reason}" for one in bad)
    told = {name: made[-1].figures.get(name) for name in OF_STATE}
    worst = bad[0] if bad else made[-1]
    return {
        **told,
        STATUS: worst.figures.get(STATUS) or worst.outcome,
        REASONS: "; ".join(lines),
        NOT_OK: bool(bad),
        "states": len(made),
    }


def _last_state(arguments: Mapping[str, Any]) -> str:
    """Return the file of a series's last state."""
    from physgnn.stages.patient.intraoperative.measured_files import MeasuredFiles
    from physgnn.stages.patient.intraoperative.state_table import FILES, read_states

    common = {name: arguments[name] for name in FILES if name in arguments}
    states = read_states(arguments["series"], MeasuredFiles(**common))
    return f"{states[-1].name}.vtu"


ROWS = (
    Step("segment", ("scan",), "segmentation", "seg.nii.gz"),
    Step(
        "mesh",
        ("segmentation", "brain", "mni152"),
        "case",
        "case.vtu",
        takes={"segmentation": "segmentation"},
        figures=_of_mesh,
    ),
    Step(
        "adapt",
        ("run", "preset", "loads"),
        "run",
        "run",
        takes={"case": "case"},
        defaults={"run": None},
        figures=_of_adapted,
    ),
    Step(
        "predict",
        ("load",),
        "shift",
        "shift.vtu",
        takes={"run": "run"},
        defaults={"run": None},
        of_mesh="run",
        writes={"form": None, "image": None},
        figures=_of_prediction,
    ),
    Step(
        "register",
        ("points", "surface", "landmarks", "whole_surface", "intraoperative", "series"),
        "shift",
        "shift.vtu",
        takes={"mesh": "case"},
        writes={
            "form": None,
            "image": None,
            "picture": None,
            "misfits": "misfits.csv",
            "report": None,
        },
        figures=_of_registration,
        several=Several("series", "states", _last_state),
    ),
    Step(
        "warp",
        ("image",),
        "deformed",
        "deformed.nii.gz",
        takes={"prediction": "shift"},
        writes={"field": ["shift.h5"], "jacobian": None, "slices": "slices.png"},
    ),
)


def steps() -> tuple[Step, ...]:
    """Return the steps whose stage there is."""
    there = set(dir(stages))
    return tuple(row for row in ROWS if row.command in there)

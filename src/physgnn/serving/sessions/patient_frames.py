"""What the page is told of a craniotomy and of a registered state."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from physgnn.errors import InputError
from physgnn.serving.patient.desk import FailedState, Opening, RegisteredShift
from physgnn.serving.protocol.frames import encode
from physgnn.serving.scene.colours import SolvedLoad
from physgnn.serving.scene.section import Section
from physgnn.serving.sessions.engine import Engine
from physgnn.serving.sessions.predictions import described, drawn_arrays

REGISTRATION = "registration"  # what found the displacement, on the page
MOST_LISTED = 2000  # measured places that are drawn; a surface has more
NamedState: TypeAlias = tuple[str, RegisteredShift | FailedState]


def opening_frame(engine: Engine, opening: Opening) -> bytes:
    """Return which of the points drawn are laid open, and which are held."""
    header = {
        "kind": "craniotomy",
        "centre_mm": opening.centre_mm.tolist(),
        "area_cm2": opening.area_mm2 / 100,
        "n_loaded": len(opening.loaded),
        "n_held": len(opening.fixed),
    }
    shown = engine.shown.nodes
    arrays = {
        "loaded": np.isin(shown, opening.loaded).astype(np.uint8),
        "held": np.isin(shown, opening.fixed).astype(np.uint8),
    }
    return encode(header, arrays)


def failed_rows(states: Sequence[NamedState]) -> list[dict[str, int | str]]:
    """Return which states of a series could not be registered, and why."""
    return [
        {"state": number, "name": name, "reason": state.reason}
        for number, (name, state) in enumerate(states)
        if isinstance(state, FailedState)
    ]


def shift_of(states: Sequence[NamedState], number: int) -> RegisteredShift:
    """Return a registered state.

    Raises
    ------
    InputError
        If it is not there, or could not be registered.
    """
    if number >= len(states):
        raise InputError("this state is not registered: register it again")
    name, state = states[number]
    if isinstance(state, FailedState):
        raise InputError(f"{name} could not be registered: {state.reason}")
    return state


def state_frame(
    engine: Engine,
    states: Sequence[NamedState],
    number: int,
    field: str,
    section: Section | None,
) -> bytes:
    """Return one registered state of a series, at the points drawn."""
    shift = shift_of(states, number)
    name, found = states[number][0], shift.found
    solved = SolvedLoad(REGISTRATION, None, found.prediction, found.deviation_mm)
    worst = sorted(found.misfits, key=lambda one: -one.distance_mm)
    listed = worst[:MOST_LISTED]
    header = {
        "kind": "state",
        "state": number,
        "states": len(states),
        "failed": failed_rows(states),
        "name": name,
        **described(engine, field, solved),
        "deviation_mm": float(found.deviation_mm.mean()),
        "misfit_mm": _known(found.misfit_mm),
        "held_out_mm": _known(found.held_out_mm),
        "offset": {
            "length_mm": found.offset.length_mm,
            "turn_deg": found.offset.turn_deg,
            "probability": found.offset.probability,
            "corrected": found.offset.corrected,
            "bone": None if found.bone is None else str(found.bone),
        },
        "notes": list(shift.notes),
        "places": len(found.misfits),
        "misfits": [
            {
                "kind": one.kind,
                "label": one.label,
                "mm": one.distance_mm,
                "weight": one.weight,
                "outlier": one.is_outlier,
            }
            for one in listed
        ],
    }
    arrays = drawn_arrays(engine, field, solved, section)
    arrays["measured"] = np.array(
        [(one.x_mm, one.y_mm, one.z_mm) for one in listed], dtype=np.float64
    ).reshape(-1, 3)
    return encode(header, arrays)


def _known(value: float) -> float | None:
    return value if np.isfinite(value) else None

"""The messages a browser may send, with every field checked."""

import math
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, TypeAdapter, ValidationError

from physgnn.errors import InputError
from physgnn.serving.protocol.fields import (
    Axis,
    CheckedMessage,
    Coordinate,
    FieldName,
    Number,
)
from physgnn.serving.protocol.patient_messages import PatientMessage

MAX_BYTES = 4096
MAX_FORCE_N = 1000.0
MAX_RADIUS_MM = 200.0

PredictorName = Literal["network", "linear"]


class PatchLoad(CheckedMessage):
    """A force on a patch of the exposed surface, and what is wanted for it.

    Attributes
    ----------
    id : int
        Comes back with every prediction for this patch load.
    point : three floats
        Centre of the patch at rest, mm.
    force_n : three floats
        Force on the whole patch, N, not zero.
    radius_mm : float
        Radius of the patch.
    predictors : list of str
        Which predictors are wanted at once.
    field : str
        Which scalar comes with the displacement: a row of `fields.FIELDS`.
    solve : bool
        Whether finite elements shall follow in the background.
    """

    type: Literal["patch_load"] = "patch_load"
    id: Annotated[int, Field(ge=0, lt=2**53)] = 0
    point: tuple[Coordinate, Coordinate, Coordinate]
    force_n: tuple[Number, Number, Number]
    radius_mm: Annotated[Number, Field(gt=0, le=MAX_RADIUS_MM)]
    predictors: Annotated[list[PredictorName], Field(min_length=1, max_length=2)]
    field: FieldName = "displacement"
    solve: bool = False


class SectionPlane(CheckedMessage):
    """A plane to cut the brain with, or none.

    Attributes
    ----------
    axis : str or None
        Which plane; None takes it away.
    offset_mm : float
        Where it meets its axis, world coordinates.
    """

    type: Literal["section"] = "section"
    axis: Axis | None
    offset_mm: Coordinate = 0.0


class Release(CheckedMessage):
    """Let go: nothing more is wanted for the last patch load."""

    type: Literal["release"] = "release"


LoadMessage: TypeAlias = PatchLoad | SectionPlane | Release
Message: TypeAlias = LoadMessage | PatientMessage
_READER: TypeAdapter[Message] = TypeAdapter(
    Annotated[Message, Field(discriminator="type")]
)


def read_message(content: str | bytes) -> Message:
    """Return a message from the browser.

    Raises
    ------
    InputError
        If it is too long, no JSON, or a field is missing, unknown or out of range.
    """
    if isinstance(content, bytes):
        raise InputError("messages must be JSON text (got binary)")
    if len(content) > MAX_BYTES:
        raise InputError(
            f"a message must have at most {MAX_BYTES} characters (got {len(content)})"
        )
    try:
        message = _READER.validate_json(content)
    except ValidationError as error:
        raise InputError(_first(error)) from error
    if isinstance(message, PatchLoad):
        _check_force(message)
    return message


def read_patch_load(content: str | bytes) -> PatchLoad:
    """Return a message that must be a patch load; InputError if it is not."""
    message = read_message(content)
    if not isinstance(message, PatchLoad):
        raise InputError(f"a patch load is wanted here (got {message.type})")
    return message


def _check_force(patch_load: PatchLoad) -> None:
    size = math.hypot(*patch_load.force_n)
    if not 0 < size <= MAX_FORCE_N:
        raise InputError(
            f"force_n must be longer than 0 and at most {MAX_FORCE_N:g} N "
            f"(got {size:g})"
        )


def _first(error: ValidationError) -> str:
    what = error.errors(include_url=False, include_input=False)[0]
    tag = what["loc"][:1] if len(what["loc"]) > 1 else ()  # which message it is
    where = ".".join(str(part) for part in what["loc"][len(tag) :])
    return f"{where or 'message'}: {what['msg']}"

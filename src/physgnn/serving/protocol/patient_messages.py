"""The messages about a patient: a craniotomy, measured files, their registration."""

from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from physgnn.serving.protocol.fields import (
    CheckedMessage,
    Coordinate,
    FieldName,
    Number,
)

MAX_FILE_BYTES = 32 << 20  # a brain's surface of 300,000 points
MAX_TOTAL_BYTES = 64 << 20  # of one session
MOST_FILES = 32
RADIUS_MM = (5.0, 100.0)  # as of `physgnn init`


Word = Annotated[str, Field(max_length=40)]


class TriedCraniotomy(CheckedMessage):
    """Where the skull might be open: it is shown, and nothing more.

    Attributes
    ----------
    point : three floats
        On the cortex at rest, mm.
    radius_mm : float
        Of what is laid open.
    """

    type: Literal["craniotomy"] = "craniotomy"
    point: tuple[Coordinate, Coordinate, Coordinate]
    radius_mm: Annotated[Number, Field(ge=RADIUS_MM[0], le=RADIUS_MM[1])]


class OpenSkull(CheckedMessage):
    """Open the skull where it was shown last."""

    type: Literal["open_skull"] = "open_skull"


class AdaptNetwork(CheckedMessage):
    """Make the network that comes with the package ready for the case."""

    type: Literal["adapt"] = "adapt"


class MeasuredFile(CheckedMessage):
    """A file that follows in binary messages of any size.

    Attributes
    ----------
    name : str
        What it is called on the page; only its ending counts.
    role : str
        One of the roles that the desk offers.
    n_bytes : int
        How many bytes follow.
    """

    type: Literal["measured_file"] = "measured_file"
    name: Annotated[str, Field(min_length=1, max_length=200)]
    role: Annotated[str, Field(max_length=40)]
    n_bytes: Annotated[int, Field(gt=0, le=MAX_FILE_BYTES)]


class Forget(CheckedMessage):
    """Forget all measured files."""

    type: Literal["forget"] = "forget"


class Register(CheckedMessage):
    """Register what was measured.

    Attributes
    ----------
    noise_mm : float
        Standard deviation of each coordinate measured.
    rigid_offset : bool
        Correct a rigid offset of the navigation.
    chosen : mapping of str to str
        Name of a menu that the desk offers → the value chosen.
    """

    type: Literal["register"] = "register"
    noise_mm: Annotated[Number, Field(gt=0, le=20)] = 1.0
    rigid_offset: bool = False
    chosen: Annotated[dict[Word, Word], Field(max_length=8)] = Field(
        default_factory=dict
    )


class ShowState(CheckedMessage):
    """Show a state that was registered.

    Attributes
    ----------
    state : int
        Which of a series, from 0.
    field : str
        Which scalar comes with it.
    """

    type: Literal["state"] = "state"
    state: Annotated[int, Field(ge=0, lt=MOST_FILES)]
    field: FieldName = "displacement"


class SendMisfits(CheckedMessage):
    """Send how far every measured place of a state is off, as CSV.

    Attributes
    ----------
    state : int
        Which of a series, from 0.
    """

    type: Literal["misfits"] = "misfits"
    state: Annotated[int, Field(ge=0, lt=MOST_FILES)]


class Save(CheckedMessage):
    """Keep the states that were registered."""

    type: Literal["save"] = "save"


PatientMessage: TypeAlias = (
    TriedCraniotomy
    | OpenSkull
    | AdaptNetwork
    | MeasuredFile
    | Forget
    | Register
    | ShowState
    | SendMisfits
    | Save
)

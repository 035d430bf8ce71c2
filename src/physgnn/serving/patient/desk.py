"""What the page may do for a patient; the stages do it as their commands would.

The server knows no folder and no command: it is handed a desk, and hands it the files
that a browser sent, under names of its own.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry import TetMesh

if TYPE_CHECKING:  # torch takes seconds to import
    from physgnn.registration.result import Registration


@dataclass(frozen=True, eq=False)
class Opening:
    """A craniotomy.

    Attributes
    ----------
    centre_mm : (3,) array
        The point of the cortex in its middle.
    loaded, fixed : integer arrays
        Points of the mesh laid open, and held by the skull.
    area_mm2 : float
        Of the surface laid open.
    text : str
        The case file that says so, TOML.
    """

    centre_mm: FloatArray
    loaded: IntArray
    fixed: IntArray
    area_mm2: float
    text: str


@dataclass(frozen=True)
class MeasuredState:
    """What was measured of one state of the brain.

    Attributes
    ----------
    name : str
        What the page calls it.
    files : mapping of str to Path
        A role of the desk → its file.
    called : mapping of str to str
        The same → what the page calls the file.
    """

    name: str
    files: Mapping[str, Path]
    called: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class RegisterOptions:
    """What is alike for all states.

    Attributes
    ----------
    noise_mm : float
        Standard deviation of each coordinate measured.
    rigid_offset : bool
        Whether to correct a rigid offset of the navigation.
    chosen : mapping of str to str
        Name of a menu of the desk → one of its values, where it was on show.
    """

    noise_mm: float = 1.0
    rigid_offset: bool = False
    chosen: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class RegisteredShift:
    """A state of the brain as registered, and the files that a command writes of it.

    Attributes
    ----------
    found : Registration
        Displacement, error bound, status and its reasons, deviation, misfits, offset.
    file, misfits : Path
        What ``physgnn register`` wrote, and what its ``--misfits`` did.
    notes : tuple of str
        What it said but for the outliers: points left out, that no bone was measured.
    """

    found: "Registration"
    file: Path
    misfits: Path
    notes: tuple[str, ...]


@dataclass(frozen=True)
class FailedState:
    """A state of a series that could not be registered.

    Attributes
    ----------
    reason : str
        Why, in one line.
    """

    reason: str


@dataclass(frozen=True)
class Menu:
    """What is chosen where a file of some role is there.

    Attributes
    ----------
    title : str
        On the page.
    values : mapping of str to str
        Value → its name on the page; the first is chosen until another is.
    roles : sequence of str
        Of the files that call for it.
    """

    title: str
    values: Mapping[str, str]
    roles: Sequence[str]


class Desk(Protocol):
    """What can be done for the patient on show.

    Attributes
    ----------
    note : str
        What stands in for what the case does not say, for the page.
    saves : bool
        Whether there is a folder to save in.
    adapts : bool
        Whether a network can be adapted that is not yet.
    roles : mapping of str to str
        What a measured file may be → its name on the page.
    suffixes : sequence of str
        How measured files may end.
    menus : mapping of str to Menu
        What is chosen where some files are there.
    """

    @property
    def note(self) -> str: ...  # noqa: D102
    @property
    def saves(self) -> bool: ...  # noqa: D102
    @property
    def adapts(self) -> bool: ...  # noqa: D102
    @property
    def roles(self) -> Mapping[str, str]: ...  # noqa: D102
    @property
    def suffixes(self) -> Sequence[str]: ...  # noqa: D102
    @property
    def menus(self) -> Mapping[str, Menu]: ...  # noqa: D102
    @property
    def mesh(self) -> TetMesh:
        """The mesh, with the points that are held and laid open."""

    def opening(self, point: FloatArray, radius_mm: float) -> Opening:
        """Return the craniotomy about the cortex nearest to a point."""

    def open(self, opening: Opening) -> list[str]:
        """Hold and load the mesh so from now on; return the files that say so."""

    def adapt(self) -> Path:
        """Return a run folder that predicts on the case, held and loaded as it is."""

    def register(
        self, states: Sequence[MeasuredState], folder: Path, options: RegisterOptions
    ) -> Iterator[RegisteredShift | FailedState]:
        """Register states one after the other, written into a folder that is there."""

    def save(self, states: Sequence[RegisteredShift | FailedState]) -> list[str]:
        """Keep the states; return the names of the files."""

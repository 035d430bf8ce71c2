"""What the page may do for a patient; the stages do it as their commands would.

The server knows no folder and no command: it is handed a desk, and hands it the files
that a browser sent, under names of its own.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry import TetMesh
from physgnn.prediction.prediction import Prediction


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
class PointMisfit:
    """How far the registration is from one measured place.

    Attributes
    ----------
    label : str
        Its name or number.
    place_mm : three floats
        Where it was measured.
    distance_mm : float
        From where the registration puts it.
    is_outlier : bool
        Whether the rest contradicts it.
    """

    label: str
    place_mm: tuple[float, float, float]
    distance_mm: float
    is_outlier: bool


@dataclass(frozen=True, eq=False)
class RegisteredShift:
    """A state of the brain as registered, and the file that a command writes of it.

    Attributes
    ----------
    prediction : Prediction
        Displacement, error bound, status and its reasons.
    deviation_mm : (n_points,) array
        Standard deviation of each point's displacement.
    misfit_mm, held_out_mm : float
        Root mean squares over what was measured, and over what was left out.
    misfits : tuple of PointMisfit
        One a measured place.
    file : Path
        What ``physgnn register`` wrote.
    notes : tuple of str
        What it said: points left out, outliers.
    """

    prediction: Prediction
    deviation_mm: FloatArray
    misfit_mm: float
    held_out_mm: float
    misfits: tuple[PointMisfit, ...]
    file: Path
    notes: tuple[str, ...]


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
    def mesh(self) -> TetMesh:
        """The mesh, with the points that are held and laid open."""

    def opening(self, point: FloatArray, radius_mm: float) -> Opening:
        """Return the craniotomy about the cortex nearest to a point."""

    def open(self, opening: Opening) -> list[str]:
        """Hold and load the mesh so from now on; return the files that say so."""

    def adapt(self) -> Path:
        """Return a run folder that predicts on the case, held and loaded as it is."""

    def register(
        self, files: Mapping[str, Path], out: Path, noise_mm: float
    ) -> RegisteredShift:
        """Register what was measured, a file a role, and write it to a file."""

    def save(self, shifts: Sequence[RegisteredShift]) -> list[str]:
        """Keep the states; return the names of the files."""

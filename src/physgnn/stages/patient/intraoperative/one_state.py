"""One state of a brain, from its measured files to the file of its displacement."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.arrays import FloatArray
from physgnn.geometry.image import ImageGrid
from physgnn.io.displacement_files import DisplacementFields
from physgnn.io.vtk.error_fields import COVARIANCE, DEVIATION, packed
from physgnn.progress import Log, no_log
from physgnn.registration.removed_region import Resected
from physgnn.stages.patient.intraoperative.measured_files import (
    Measured,
    MeasuredFiles,
    read_measured,
)
from physgnn.stages.patient.intraoperative.patient_body import PatientBody
from physgnn.stages.patient.intraoperative.scan_surface import (
    ScanOptions,
    brain_surface,
)

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.registration.registrar import Registrar
from physgnn.registration.misfits import Misfit
from physgnn.registration.result import Registration

OUTLIER = "outlier"  # begins what is said of one
OUTLIERS_NAMED = 20  # a whole surface may have hundreds
SEGMENTED_MM = 2.0  # noise of a segmented brain's surface: two voxels of a usual scan
Write = Callable[[Path, DisplacementFields], None]


@dataclass(frozen=True)
class HowToRegister:
    """What is alike for all states of an operation.

    Attributes
    ----------
    noise_mm : float
        Of what has none of its own.
    noises : mapping
        Kind of measurement → its own noise, mm. That of a segmented brain is 2 mm at
        least, by default.
    rigid_offset : bool
        Correct a rigid offset of the navigation.
    transformed : str
        A row of `physgnn.stages.patient.intraoperative.measured_files.TRANSFORMED`.
    scan : ScanOptions
        How an intraoperative scan is segmented.
    """

    noise_mm: float = 1.0
    noises: Mapping[str, float] = field(default_factory=dict)
    rigid_offset: bool = False
    transformed: str = "both"
    scan: ScanOptions = ScanOptions()  # noqa: RUF009 (it is frozen)

    def noise_of(self, files: MeasuredFiles) -> dict[str, float]:
        """Return the noise of every kind of measurement of a state, mm."""
        kinds = ("pairs", "landmarks", "surface", "bone")
        default = dict.fromkeys(kinds, self.noise_mm)
        whole = (
            self.noise_mm
            if files.intraoperative is None
            else max(self.noise_mm, SEGMENTED_MM)
        )
        return {**default, "whole surface": whole, **self.noises}


@dataclass(frozen=True, eq=False)
class RegisteredState:
    """A registered state.

    Attributes
    ----------
    found : Registration
        What was found.
    measured : list
        What it was found from.
    """

    found: "Registration"
    measured: list[Measured]


def register_state(
    registrar: "Registrar",
    files: MeasuredFiles,
    how: HowToRegister,
    *,
    resection: Resected | None = None,
    after: FloatArray | None = None,
    picture: Path | None = None,
    log: Log = no_log,
) -> RegisteredState:
    """Find the displacement that one state's files tell of.

    Parameters
    ----------
    registrar : Registrar
        Of the patient.
    files : MeasuredFiles
        What was measured.
    how : HowToRegister
        How.
    resection : Resected, optional
        What was removed, of which nothing can have been measured.
    after : (n_points, 3) array, optional
        Displacement of the state before, mm, to begin at.
    picture : Path, optional
        Where the outline of an intraoperative brain goes, PNG.
    log : callable
        Called with what was left out, and the outliers.

    Raises
    ------
    InputError
        If a file cannot be used, or what was measured is far from the brain.
    """
    scanned = partial(
        brain_surface, mesh=registrar.body.mesh, how=how.scan, picture=picture, log=log
    )
    measured = read_measured(
        files, transformed_ends=how.transformed, scanned=scanned, log=log
    )
    if resection is not None:
        resection.check_measured(measured)
    found = registrar(
        measured,
        noise_mm=how.noise_of(files),
        rigid_offset=how.rigid_offset,
        after=after,
    )
    for line in outlier_lines(found.outliers):
        log(line)
    return RegisteredState(found, measured)


def outlier_lines(outliers: Sequence[Misfit]) -> Iterator[str]:
    """Yield a line for each of the farthest outliers, and one for the rest."""
    for one in outliers[:OUTLIERS_NAMED]:
        yield f"{OUTLIER}, {one}, weight {one.weight:.2f}"
    if len(outliers) > OUTLIERS_NAMED:
        more = len(outliers) - OUTLIERS_NAMED
        yield f"{OUTLIER}s, {more} more: --misfits FILE.csv lists all"


def write_state(
    out: Path,
    patient: PatientBody,
    found: "Registration",
    write: Write,
    grid: ImageGrid | None = None,
) -> None:
    """Write a displacement: deviation, covariance, forces, status, navigation."""
    fields = {
        "displacement_mm": found.prediction.displacement,
        DEVIATION: found.deviation_mm,
        COVARIANCE: packed(found.covariance_mm2),
        "force_n": found.forces,
    }
    said = str(found.prediction.status), found.prediction.reasons
    gone = None if patient.resection is None else patient.resection.removed
    told = navigation_lines(found)
    write(out, DisplacementFields(patient.body.mesh, fields, grid, *said, gone, told))


def navigation_lines(found: "Registration") -> tuple[str, ...]:
    """Return what is known of the navigation: its offset, and each point of the bone.

    The offset is what the navigation adds to a place of the scan, about a centre, RAS.
    """
    offset = found.offset
    parts = {
        "translation, mm": (offset.translation_mm, offset.deviation_mm),
        "rotation, degrees": (offset.rotation_deg, offset.deviation_deg),
    }
    return (
        found.navigation,
        *(
            f"{name}: {_numbers(one)} +- {_numbers(d)}"
            for name, (one, d) in parts.items()
        ),
        f"about, mm: {_numbers(offset.centre_mm)}",
        *(
            f"{one}, weight {one.weight:.2f}"
            for one in found.misfits
            if one.kind == "bone"
        ),
    )


def _numbers(vector: FloatArray) -> str:
    return " ".join(f"{value:.4f}" for value in vector)

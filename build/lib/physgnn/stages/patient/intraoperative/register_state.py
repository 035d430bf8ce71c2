"""One state of a brain, from its measured files to the file of its displacement."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.config import read_materials, read_membranes
from physgnn.errors import InputError
from physgnn.geometry import TetMesh
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.regions import REGIONS
from physgnn.io import read_mesh
from physgnn.io.displacement_files import DisplacementFields
from physgnn.io.vtk.error_fields import COVARIANCE, DEVIATION, packed
from physgnn.mechanics.body import Body
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.materials.tissues import TISSUES
from physgnn.progress import Log, no_log
from physgnn.stages.patient.intraoperative.measured_files import (
    Measured,
    MeasuredFiles,
    read_measured,
)
from physgnn.stages.patient.intraoperative.removed_region import Resected, resected
from physgnn.stages.patient.intraoperative.scan_surface import (
    ScanOptions,
    brain_surface,
)

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.registration.registrar import Registrar, Registration

SEGMENTED_MM = 2.0  # noise of a segmented brain's surface: two voxels of a usual scan
Write = Callable[[Path, DisplacementFields], None]

DEFAULT_MATERIALS: Mapping[int, Material] = {
    region: TISSUES[name].material for region, name in enumerate(REGIONS)
}


@dataclass(frozen=True)
class HowToRegister:
    """What is alike for all states of an operation.

    Attributes
    ----------
    noise_mm : float
        Of what has none of its own.
    noises : mapping
        Kind of measurement → its own noise, mm, or None. That of a segmented brain is
        2 mm at least, by default.
    rigid_offset : bool
        Correct a rigid offset of the navigation.
    transformed : str
        A row of `physgnn.stages.patient.intraoperative.measured_files.TRANSFORMED`.
    scan : ScanOptions
        How an intraoperative scan is segmented.
    """

    noise_mm: float = 1.0
    noises: Mapping[str, float | None] | None = None
    rigid_offset: bool = False
    transformed: str = "both"
    scan: ScanOptions = ScanOptions()  # noqa: RUF009 (it is frozen)

    def noise_of(self, files: MeasuredFiles) -> dict[str, float]:
        """Return the noise of every kind of measurement of a state, mm."""
        default = dict.fromkeys(("pairs", "landmarks", "surface"), self.noise_mm)
        whole = (
            self.noise_mm
            if files.intraoperative is None
            else max(self.noise_mm, SEGMENTED_MM)
        )
        own = {k: v for k, v in (self.noises or {}).items() if v is not None}
        return {**default, "whole surface": whole, **own}


@dataclass(frozen=True)
class HowItIsHeld:
    """What is known of a patient's brain before anything is measured.

    Attributes
    ----------
    skull : str
        A row of `physgnn.registration.skull.SUPPORTS`.
    remove : str or None
        The region that was resected.
    causes : str or None
        Rows of `physgnn.registration.causes.CAUSES`, with commas; "none" for none, None
        for all that the body has the sets for.
    membranes, materials : path or None
        TOML with a table ``[membranes]``, and with ``[materials.<region>]``.
    """

    skull: str = "fixed"
    remove: str | None = None
    causes: str | None = None
    membranes: str | Path | None = None
    materials: str | Path | None = None

    @property
    def named_causes(self) -> tuple[str, ...] | None:
        """The causes one by one; None takes all there are."""
        if self.causes is None:
            return None
        names = self.causes.split(",")
        return () if self.causes == "none" else tuple(name.strip() for name in names)


@dataclass(frozen=True, eq=False)
class Patient:
    """Whose brain is registered.

    Attributes
    ----------
    body : Body
        At rest, without what was removed.
    make : callable
        Returns the registrar; it takes seconds, so call it when the first state needs
        it.
    told : mapping
        What else the displacement depends on, for its digest.
    resection : Resected or None
        What was removed.
    """

    body: Body
    make: Callable[[], "Registrar"]
    told: Mapping[str, Any]
    resection: Resected | None = None


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


def patient_of(mesh: str | Path, held: HowItIsHeld) -> Patient:
    """Return the patient of a mesh file; by default of the published tissues.

    Raises
    ------
    InputError
        If a file cannot be used, or what is removed is not there.
    """
    case, resection = read_mesh(mesh), None
    if held.remove is not None:
        resection = resected(case, held.remove)
        case = resection.remaining
    given = {} if held.materials is None else read_materials(held.materials)
    body = Body(case, {**DEFAULT_MATERIALS, **given})
    membranes = read_membranes(held.membranes)
    causes = held.named_causes

    def make() -> "Registrar":
        from physgnn.registration.registrar import Registrar

        return Registrar(body, skull=held.skull, causes=causes, membranes=membranes)

    told = {"skull": held.skull, "causes": causes, "membranes": repr(membranes)}
    return Patient(body, make, told, resection)


def ready_patient(registrar: "Registrar") -> Patient:
    """Return the patient of a registrar that is ready."""
    told = {
        "skull": registrar.skull,
        "causes": registrar.causes,
        "membranes": repr(registrar.membranes),
    }
    return Patient(registrar.body, lambda: registrar, told)


def ready_registrar(
    mesh: str | Path,
    *,
    skull: str = "fixed",
    causes: str | None = None,
    membranes: str | Path | None = None,
    materials: str | Path | None = None,
) -> "Registrar":
    """Return what `physgnn.register` takes as `registrar`, to register many times.

    Load modes and factors take seconds; they are the same for every measurement.

    Parameters
    ----------
    mesh, skull, causes, membranes, materials
        As of `physgnn.register`.

    Raises
    ------
    InputError
        If a file cannot be used, or the fixed points do not hold the body.
    """
    held = HowItIsHeld(skull, None, causes, membranes, materials)
    return patient_of(mesh, held).make()


def checked_registrar(
    registrar: "Registrar", mesh: str | Path, held: HowItIsHeld
) -> "Registrar":
    """Return a registrar that was made ready for this mesh.

    Raises
    ------
    InputError
        If it is of another mesh, or options are given that it has its own of.
    """
    own, usual = asdict(held), asdict(HowItIsHeld())
    given = [name for name, value in own.items() if value != usual[name]]
    if given:
        raise InputError(
            f"a registrar has {' and '.join(given)} of its own: leave them out"
        )
    named, its = read_mesh(mesh), registrar.body.mesh
    if not _same(named, its):
        raise InputError(
            f"{mesh}: the registrar must be of this mesh (it is of another, of "
            f"{its.n_points} points): make one by ready_registrar"
        )
    return registrar


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
    for one in found.outliers:
        log(f"outlier, {one}, weight {one.weight:.2f}")
    return RegisteredState(found, measured)


def write_state(
    out: Path,
    patient: Patient,
    found: "Registration",
    write: Write,
    grid: ImageGrid | None = None,
) -> None:
    """Write a displacement with its deviation, covariance, forces and status."""
    fields = {
        "displacement_mm": found.prediction.displacement,
        DEVIATION: found.deviation_mm,
        COVARIANCE: packed(found.covariance_mm2),
        "force_n": found.forces,
    }
    said = str(found.prediction.status), found.prediction.reasons
    gone = None if patient.resection is None else patient.resection.removed
    write(out, DisplacementFields(patient.body.mesh, fields, grid, *said, gone))


def _same(one: TetMesh, other: TetMesh) -> bool:
    return (
        np.array_equal(one.points, other.points)
        and np.array_equal(one.cells, other.cells)
        and np.array_equal(one.region, other.region)
        and set(_fixed(one)) == set(_fixed(other))
    )


def _fixed(mesh: TetMesh) -> list[int]:
    return [int(i) for i in mesh.point_sets.get("fixed", ())]

"""One state of a brain, from its measured files to the file of its displacement."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.config import read_materials
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
from physgnn.stages.patient.intraoperative import ScanOptions, brain_surface
from physgnn.stages.patient.measured_files import (
    Measured,
    MeasuredFiles,
    read_measured,
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
        A row of `physgnn.stages.patient.measured_files.TRANSFORMED`.
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


def body_of(mesh: str | Path, materials: str | Path | None) -> Body:
    """Return the body of a mesh file; by default of the published tissues."""
    given = {} if materials is None else read_materials(materials)
    return Body(read_mesh(mesh), {**DEFAULT_MATERIALS, **given})


def ready_registrar(
    mesh: str | Path, *, skull: str = "fixed", materials: str | Path | None = None
) -> "Registrar":
    """Return what `physgnn.register` takes as `registrar`, to register many times.

    Load modes and factors take seconds; they are the same for every measurement.

    Parameters
    ----------
    mesh, skull, materials
        As of `physgnn.register`.

    Raises
    ------
    InputError
        If a file cannot be used, or the fixed points do not hold the body.
    """
    from physgnn.registration.registrar import Registrar

    return Registrar(body_of(mesh, materials), skull=skull)


def checked_registrar(
    registrar: "Registrar", mesh: str | Path, options: Mapping[str, Any]
) -> "Registrar":
    """Return a registrar that was made ready for this mesh.

    Raises
    ------
    InputError
        If it is of another mesh, or options are given that it has its own of.
    """
    given = [name for name, value in options.items() if value]
    if given:
        raise InputError(
            f"a registrar has {' and '.join(given)} of its own: leave them out"
        )
    named, own = read_mesh(mesh), registrar.body.mesh
    if not _same(named, own):
        raise InputError(
            f"{mesh}: the registrar must be of this mesh (it is of another, of "
            f"{own.n_points} points): make one by ready_registrar"
        )
    return registrar


def register_state(
    registrar: "Registrar",
    files: MeasuredFiles,
    how: HowToRegister,
    *,
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
    mesh: TetMesh,
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
    write(out, DisplacementFields(mesh, fields, grid, *said))


def _same(one: TetMesh, other: TetMesh) -> bool:
    return (
        np.array_equal(one.points, other.points)
        and np.array_equal(one.cells, other.cells)
        and np.array_equal(one.region, other.region)
        and np.array_equal(one.point_sets.get("fixed"), other.point_sets.get("fixed"))
    )

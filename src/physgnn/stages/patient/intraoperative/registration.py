"""From what was measured in the operating theatre to the displacement of a brain."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.config import read_materials, read_membranes
from physgnn.geometry.regions import REGIONS
from physgnn.io import read_mesh
from physgnn.io.displacement_files import DisplacementFields, form_of
from physgnn.io.medical.images.formats import read_image
from physgnn.io.vtk.error_fields import COVARIANCE, DEVIATION, packed
from physgnn.mechanics.body import Body
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.materials.tissues import TISSUES
from physgnn.progress import Log, no_log
from physgnn.stages.outputs import FILE, FOLDER, Output, writes
from physgnn.stages.patient.intraoperative.measured_files import read_measured
from physgnn.stages.patient.intraoperative.registration_report import (
    page_in,
    registered_case,
    write_page,
)
from physgnn.stages.patient.intraoperative.removed_region import resected

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.registration.registrar import Registration

DEFAULT_MATERIALS: Mapping[int, Material] = {
    region: TISSUES[name].material for region, name in enumerate(REGIONS)
}


@writes(out=FILE, misfits=Output((".csv",)), report=FOLDER)
def register(
    mesh: str | Path,
    out: str | Path,
    *,
    points: str | Path | None = None,
    target: str | Path | None = None,
    landmarks: str | Path | None = None,
    landmarks_target: str | Path | None = None,
    surface: str | Path | None = None,
    whole_surface: str | Path | None = None,
    initial_transform: str | Path | None = None,
    transformed: str = "both",
    noise_mm: float = 1.0,
    landmark_noise_mm: float | None = None,
    surface_noise_mm: float | None = None,
    whole_surface_noise_mm: float | None = None,
    rigid_offset: bool = False,
    skull: str = "fixed",
    remove: str | None = None,
    causes: str | None = None,
    membranes: str | Path | None = None,
    materials: str | Path | None = None,
    form: str | None = None,
    image: str | Path | None = None,
    affine: str | None = None,
    misfits: str | Path | None = None,
    report: str | Path | None = None,
    log: Log = no_log,
) -> "Registration":
    """Find the displacement of a whole brain from what was measured of it.

    It is written whatever its status is, with the status and the reasons for it inside.
    Everything that is given counts, each with its own noise.

    Parameters
    ----------
    mesh : path
        VTU with the point set of the skull.
    out : path
        Where the displacement goes; `physgnn warp` takes a VTU.
    points, target : path
        Points of the surface before and after: see
        `physgnn.io.medical.markups.read_point_pairs`.
    landmarks, landmarks_target : path
        The same of points inside the brain, such as those seen by ultrasound.
    surface : path
        Where the exposed surface lies now: see
        `physgnn.io.medical.measured_surface.read_surface_points`.
    whole_surface : path
        The whole surface of the brain now, as a mesh.
    initial_transform : path
        From the space of what was measured to that of the scan: see
        `physgnn.io.medical.linear_transforms.read_rigid_transform`.
    transformed : str
        "both" ends of pairs are measured in that space, or those "after" alone, those
        before being of the scan (a row of
        `physgnn.stages.patient.intraoperative.measured_files.TRANSFORMED`).
    noise_mm : float
        Standard deviation of each coordinate measured, mm.
    landmark_noise_mm, surface_noise_mm, whole_surface_noise_mm : float, optional
        Of these kinds; by default `noise_mm`.
    rigid_offset : bool
        Correct a rigid offset of the navigation.
    skull : str
        How the skull holds the brain: see `physgnn.registration.registrar.Registrar`.
    remove : str, optional
        A region that was resected, by name or number, such as "tumour". The
        displacement is then that of the rest, and the file says what is gone.
    causes : str, optional
        Rows of `physgnn.registration.causes.CAUSES` with commas between them, or
        "none"; by default all that the body has the sets for.
    membranes : path, optional
        TOML with a table ``[membranes]``; by default falx and tentorium are left out.
    materials : path, optional
        TOML with ``[materials.<region>]`` tables; by default the tissues of the
        published work. Only ratios of stiffness matter.
    form, image, affine
        See `physgnn.stages.predict`.
    misfits : path, optional
        Where a CSV goes of how far each measured place is off, and its weight.
    report : path, optional
        Folder where ``report.html`` goes: before and after (of `image`, where one is
        given), uncertainty, misfit by point, the status and why. Made if it is missing.
    log : callable
        Called with which measured points were left out, and why, with the outliers, and
        with what the image's header leaves open.

    Returns
    -------
    Registration
        The displacement that was written, mm, with its deviation, bound and status.

    Raises
    ------
    InputError
        If a file cannot be used, what was measured is far from the brain, or a point
        lies in tissue that was removed.
    """
    from physgnn.registration.misfits import write_misfits
    from physgnn.registration.registrar import Registrar

    write = form_of(out, form).write
    page = None if report is None else page_in(report)
    scan = None if image is None else read_image(image, affine=affine, log=log)
    measured = read_measured(
        points=(points, target),
        landmarks=(landmarks, landmarks_target),
        surface=surface,
        whole_surface=whole_surface,
        initial_transform=initial_transform,
        transformed_ends=transformed,
        log=log,
    )
    case, gone = read_mesh(mesh), None
    if remove is not None:
        resection = resected(case, remove)
        resection.check_measured(measured)
        case, gone = resection.remaining, resection.removed
    given = {} if materials is None else read_materials(materials)
    registrar = Registrar(
        Body(case, {**DEFAULT_MATERIALS, **given}),
        skull=skull,
        causes=_named_causes(causes),
        membranes=read_membranes(membranes),
    )
    noises = {
        "pairs": None,
        "landmarks": landmark_noise_mm,
        "surface": surface_noise_mm,
        "whole surface": whole_surface_noise_mm,
    }
    noise = {kind: noise_mm if of is None else of for kind, of in noises.items()}
    found = registrar(measured, noise_mm=noise, rigid_offset=rigid_offset)
    for one in found.outliers:
        log(f"outlier, {one}, weight {one.weight:.2f}")
    fields = {
        "displacement_mm": found.prediction.displacement,
        DEVIATION: found.deviation_mm,
        COVARIANCE: packed(found.covariance_mm2),
        "force_n": found.forces,
    }
    said = str(found.prediction.status), found.prediction.reasons
    grid = None if scan is None else scan.grid
    write(Path(out), DisplacementFields(case, fields, grid, *said, gone))
    if misfits is not None:
        write_misfits(misfits, found.misfits)
    if page is not None:
        write_page(page, registered_case(case, found, measured, noise_mm, scan))
    return found


def _named_causes(causes: str | None) -> tuple[str, ...] | None:
    """Return the causes that a text names; None takes all there are."""
    if causes is None:
        return None
    return () if causes == "none" else tuple(c.strip() for c in causes.split(","))

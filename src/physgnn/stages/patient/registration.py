"""From what is measured of a surface to the displacement of a whole brain."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.config import read_materials
from physgnn.errors import InputError
from physgnn.geometry.measured import PointPairs, SurfacePoints
from physgnn.geometry.regions import REGIONS
from physgnn.io import read_mesh
from physgnn.io.displacement_files import DisplacementFields, form_of
from physgnn.io.medical.images.formats import read_image
from physgnn.io.medical.markups import read_point_pairs
from physgnn.io.medical.measured_surface import read_surface_points
from physgnn.mechanics.body import Body
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.materials.tissues import TISSUES
from physgnn.progress import Log, no_log

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.registration.registrar import Registration

DEFAULT_MATERIALS: Mapping[int, Material] = {
    region: TISSUES[name].material for region, name in enumerate(REGIONS)
}


def register(
    mesh: str | Path,
    out: str | Path,
    *,
    points: str | Path | None = None,
    target: str | Path | None = None,
    surface: str | Path | None = None,
    noise_mm: float = 1.0,
    skull: str = "fixed",
    materials: str | Path | None = None,
    form: str | None = None,
    image: str | Path | None = None,
    affine: str | None = None,
    log: Log = no_log,
) -> "Registration":
    """Find the displacement of a whole brain from what was measured of its surface.

    It is written whatever its status is, with the status and the reasons for it inside.

    Parameters
    ----------
    mesh : path
        VTU with the point set of the skull.
    out : path
        Where the displacement goes; `physgnn warp` takes a VTU.
    points, target : path
        Points before and after: see `physgnn.io.medical.markups.read_point_pairs`.
    surface : path
        Instead of these, where the exposed surface lies now: see
        `physgnn.io.medical.measured_surface.read_surface_points`.
    noise_mm : float
        Standard deviation of each coordinate measured.
    skull : str
        How the skull holds the brain: see `physgnn.registration.registrar.Registrar`.
    materials : path, optional
        TOML with ``[materials.<region>]`` tables; by default the tissues of the
        published work. Only ratios of stiffness matter.
    form, image, affine
        See `physgnn.stages.predict`.
    log : callable
        Called with which measured points were left out, and why, and with what the
        image's header leaves open.

    Returns
    -------
    Registration
        The displacement that was written, mm, with its deviation, bound and status.

    Raises
    ------
    InputError
        If a file cannot be used, or the points are far from the surface.
    """
    from physgnn.registration.registrar import Registrar

    write = form_of(out, form).write
    grid = None if image is None else read_image(image, affine=affine, log=log).grid
    if points is not None and surface is None:
        measured: PointPairs | SurfacePoints = read_point_pairs(points, target, log=log)
    elif surface is not None and points is None and target is None:
        measured = read_surface_points(surface, log=log)
    else:
        raise InputError("give --points (and --target), or --surface")
    case = read_mesh(mesh)
    given = {} if materials is None else read_materials(materials)
    registrar = Registrar(Body(case, {**DEFAULT_MATERIALS, **given}), skull=skull)
    found = registrar(measured, noise_mm=noise_mm)
    fields = {
        "displacement_mm": found.prediction.displacement,
        "deviation_mm": found.deviation_mm,
        "force_n": found.forces,
    }
    said = str(found.prediction.status), found.prediction.reasons
    write(Path(out), DisplacementFields(case, fields, grid, *said))
    return found

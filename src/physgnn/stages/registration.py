"""From measured points to the displacement of a whole brain."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.io import read_mesh, write_prediction
from physgnn.io.markups import read_point_pairs
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.materials.tissues import TISSUES

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.prediction.registration import Registration

DEFAULT_MATERIALS: Mapping[int, Material] = {
    region: TISSUES[name].material
    for region, name in enumerate(("brain", "tumour", "ventricle"))
}


def register(
    mesh: str | Path,
    points: str | Path,
    out: str | Path,
    *,
    target: str | Path | None = None,
    noise_mm: float = 1.0,
    materials: Mapping[int, Material] | None = None,
    fixed: str = "fixed",
) -> "Registration":
    """Find the displacement of a whole brain from measured points of its surface.

    Parameters
    ----------
    mesh : path
        VTU with the point set that the skull holds.
    points, target : path
        See `physgnn.io.markups.read_point_pairs`.
    out : path
        VTU; `physgnn warp` takes it.
    noise_mm : float
        Standard deviation of each coordinate of a measured displacement.
    materials : mapping of region to Material, optional
        By default the tissues of the published work; displacements depend on ratios of
        stiffness only.
    fixed : str
        Name of the point set.

    Raises
    ------
    InputError
        If a file cannot be used, or points are far from the surface.
    """
    from physgnn.prediction.registration import Registrar

    body = read_mesh(mesh)
    pairs = read_point_pairs(points, target)
    found = Registrar(body, materials or DEFAULT_MATERIALS, fixed)(
        pairs, noise_mm=noise_mm
    )
    fields = {
        "displacement_mm": found.prediction.displacement,
        "deviation_mm": found.deviation_mm,
        "force_n": found.forces,
    }
    write_prediction(out, body, fields)
    return found

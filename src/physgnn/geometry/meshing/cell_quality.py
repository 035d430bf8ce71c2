"""Quality of tetrahedra: three measures a cell, a summary, and a floor."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh, shape_gradients

# A cell below this mean ratio is a sliver that locks or inverts at once; the
# published brain mesh's worst cell has 0.092.
DEFAULT_FLOOR = 0.02
EDGES = list(combinations(range(4), 2))


@dataclass(frozen=True)
class Quality:
    """Worst and middle cells of a mesh.

    Attributes
    ----------
    mean_ratio_min, mean_ratio_median : float
        See `mean_ratio`.
    dihedral_min_deg : float
        Smallest angle between two faces of a cell.
    radius_edge_max : float
        Largest circumradius over shortest edge.
    worst_cell : int
        The cell of the smallest mean ratio.
    """

    mean_ratio_min: float
    mean_ratio_median: float
    dihedral_min_deg: float
    radius_edge_max: float
    worst_cell: int

    def __str__(self) -> str:
        return (
            f"quality: mean ratio {self.mean_ratio_min:.3f} at least, "
            f"{self.mean_ratio_median:.3f} median; smallest dihedral angle "
            f"{self.dihedral_min_deg:.1f}°; radius-edge ratio up to "
            f"{self.radius_edge_max:.2f}"
        )


def mean_ratio(mesh: TetMesh) -> FloatArray:
    """Return η = 12 (3V)^⅔ / Σ l² of every cell: 1 regular, 0 flat.

    Liu and Joe, Relationship between tetrahedron shape measures, BIT 34, 1994; VTK's
    "shape". The two measures below have no equal there: its "min_angle" is another than
    the dihedral angle where a cell is obtuse.
    """
    import pyvista as pv

    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
    return np.asarray(grid.cell_quality("shape")["shape"], dtype=np.float64)


def dihedral_angles(mesh: TetMesh) -> FloatArray:
    """Return the six angles between the faces of every cell, degrees, (n_cells, 6)."""
    gradients = shape_gradients(mesh.points, mesh.cells)
    unit = gradients / np.linalg.norm(gradients, axis=2, keepdims=True)
    cosines = [-np.einsum("ij,ij->i", unit[:, a], unit[:, b]) for a, b in EDGES]
    angles: FloatArray = np.degrees(np.arccos(np.clip(np.stack(cosines, 1), -1, 1)))
    return angles


def radius_edge_ratio(mesh: TetMesh) -> FloatArray:
    """Return circumradius over shortest edge of every cell: √6/4 if regular.

    The measure TetGen's quality switch bounds; it does not see slivers.
    """
    corners = mesh.points[mesh.cells]
    spokes = corners[:, 1:] - corners[:, :1]
    # the centre c, seen from the first corner, is as far from all: 2 s·c = s·s
    squares = np.einsum("ijk,ijk->ij", spokes, spokes)
    centre = np.linalg.solve(2.0 * spokes, squares[..., None])[..., 0]
    ratio: FloatArray = np.linalg.norm(centre, axis=1) / _edge_lengths(mesh).min(axis=1)
    return ratio


def quality(mesh: TetMesh) -> Quality:
    """Summarise a mesh.

    Parameters
    ----------
    mesh : TetMesh
        The mesh; lengths in mm.

    Returns
    -------
    Quality
        Mean ratio, dihedral angle and radius–edge ratio of the worst cells.
    """
    shape = mean_ratio(mesh)
    return Quality(
        mean_ratio_min=float(shape.min()),
        mean_ratio_median=float(np.median(shape)),
        dihedral_min_deg=float(dihedral_angles(mesh).min()),
        radius_edge_max=float(radius_edge_ratio(mesh).max()),
        worst_cell=int(shape.argmin()),
    )


def check_quality(mesh: TetMesh, floor: float = DEFAULT_FLOOR) -> Quality:
    """Return the summary of a mesh, or refuse it.

    Parameters
    ----------
    mesh : TetMesh
        The mesh.
    floor : float
        Smallest mean ratio accepted, in [0, 1).

    Returns
    -------
    Quality
        The summary.

    Raises
    ------
    InputError
        If a cell's mean ratio is below the floor.
    """
    if not 0.0 <= floor < 1.0:
        raise InputError(f"the quality floor must be in [0, 1) (got {floor})")
    found = quality(mesh)
    if found.mean_ratio_min < floor:
        x, y, z = mesh.points[mesh.cells[found.worst_cell]].mean(axis=0)
        below = int((mean_ratio(mesh) < floor).sum())
        raise InputError(
            f"{below} of {mesh.n_cells} cells are flatter than the floor, mean ratio "
            f"{floor:g} (worst {found.mean_ratio_min:.3g}: cell {found.worst_cell}, "
            f"near ({x:.1f}, {y:.1f}, {z:.1f}) mm): remesh the surface there more "
            "evenly, or allow smaller cells"
        )
    return found


def _edge_lengths(mesh: TetMesh) -> FloatArray:
    corners = mesh.points[mesh.cells]
    lengths = [np.linalg.norm(corners[:, a] - corners[:, b], axis=1) for a, b in EDGES]
    return np.stack(lengths, axis=1)

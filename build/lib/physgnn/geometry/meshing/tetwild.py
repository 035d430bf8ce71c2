"""Surfaces to a two-region tetrahedral mesh, by fTetWild.

Hu, Schneider, Wang, Zorin and Panozzo, Fast Tetrahedral Meshing in the Wild, ACM Trans.
Graph. 39, 2020, as the package pytetwild carries it (MPL-2.0). Its surfaces lie within
an envelope of those given, so its cells are better than TetGen's, which keeps every
point of the surfaces.
"""

from collections.abc import Sequence

import numpy as np
import pyvista as pv

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.meshing import tetwild_process
from physgnn.geometry.surface import Surface, merge, volume
from physgnn.geometry.tetmesh import TetMesh, without_unused_points

# How far the mesh's surfaces may lie from those given, mm: a tenth of a voxel.
ENVELOPE_MM = 0.1
# Relative error of the volume a region may have, and that of a small one, mm³.
VOLUME_ERROR, VOLUME_ERROR_MM3 = 0.02, 50.0


def edge_of(max_volume_mm3: float) -> float:
    """Return the edge for which the published rule bounds cells by a volume, mm.

    The rule's inverse: see `physgnn.geometry.meshing.tetrahedra.paper_max_volume`.
    """
    return float((3.0 * np.sqrt(2.0) * max_volume_mm3) ** (1 / 3))


def mesh_by_tetwild(
    brain: Surface, tumours: Sequence[Surface], edge_mm: float
) -> TetMesh:
    """Mesh a brain and what lies in it, with cells of about one edge length.

    Parameters
    ----------
    brain, tumours : Surface
        As `physgnn.geometry.tetrahedralize` takes them.
    edge_mm : float
        Edge length aimed at.

    Raises
    ------
    InputError
        If fTetWild fails or loses a part of the surfaces.
    """
    whole = merge([brain, *tumours])
    diagonal = float(np.linalg.norm(np.ptp(whole.points, axis=0)))
    try:
        points, cells = tetwild_process.run(
            whole.points, whole.faces, edge_mm, envelope=ENVELOPE_MM / diagonal
        )
    except RuntimeError as error:
        raise InputError(
            f"fTetWild could not mesh the surfaces: {error}; check them for faces that "
            "touch or cross, or mesh them by TetGen (--mesher tetgen)"
        ) from error
    centres = points[cells].mean(axis=1)
    region = np.zeros(len(cells), dtype=np.int32)
    for tumour in tumours:
        region[_enclosed(centres, tumour)] = 1
    mesh, _ = without_unused_points(points, cells, region)
    _check_volumes(mesh, brain, tumours)
    return mesh


def _enclosed(points: FloatArray, surface: Surface) -> BoolArray:
    """Return which points lie inside a closed surface."""
    low, high = surface.points.min(axis=0), surface.points.max(axis=0)
    near = np.flatnonzero(((points > low) & (points < high)).all(axis=1))
    inside = np.zeros(len(points), dtype=bool)
    if len(near):
        closed = pv.PolyData.from_regular_faces(
            surface.points, surface.faces.astype(int)
        )
        found = pv.PolyData(points[near]).select_interior_points(closed)
        inside[near] = np.asarray(found["selected_points"], dtype=bool)
    return inside


def _check_volumes(mesh: TetMesh, brain: Surface, tumours: Sequence[Surface]) -> None:
    inner = sum(volume(tumour) for tumour in tumours)
    wanted = (volume(brain) - inner, inner)
    for region, expected in enumerate(wanted):
        got = float(mesh.cell_volumes[mesh.region == region].sum())
        if abs(got - expected) > VOLUME_ERROR * expected + VOLUME_ERROR_MM3:
            raise InputError(
                f"fTetWild must keep the surfaces (region {region} has "
                f"{got / 1000:.2f} of {expected / 1000:.2f} ml): mesh them finer, or "
                "by TetGen (--mesher tetgen)"
            )

"""Surfaces to a two-region tetrahedral mesh, by TetGen as in the published work.

The merged surfaces' points are sorted by (x, y, z) and kept exactly; TetGen runs
with ``-pq1.2AaY``. Its result depends on its version and on that order: the tetgen
wheel carries TetGen 1.6.
"""

from collections.abc import Callable, Sequence

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.cell_checks import CELL_FACES
from physgnn.geometry.meshing import tetgen_process
from physgnn.geometry.surface import FaceArray, Surface, edge_lengths, merge
from physgnn.geometry.tetmesh import TetMesh

TARGET_RANGE = (1_000, 200_000)
TARGET_TOLERANCE = 0.05
TARGET_RUNS = 6
SATURATED = 0.01  # larger cells change nothing more: the surfaces set the number


def tetrahedralize(
    brain: Surface,
    tumours: Sequence[Surface] = (),
    *,
    max_volume_mm3: float | None = None,
    target_points: int | None = None,
    quality_ratio: float = 1.2,
    log: Callable[[str], None] = lambda _: None,
) -> TetMesh:
    """Mesh a brain and the tumours within it.

    Parameters
    ----------
    brain : Surface
        Closed, outward; see `check_surface`.
    tumours : sequence of Surface
        Closed, wholly inside the brain and apart; see `check_nested`.
    max_volume_mm3 : float, optional
        Cell volume above which TetGen refines; by default that of
        `paper_max_volume`. TetGen 1.6 leaves about 7 % of the cells above it.
    target_points : int, optional
        Find the cell volume that gives about this many points instead.
    quality_ratio : float
        TetGen's bound on a cell's circumradius over its shortest edge, > 1.
    log : callable
        Gets one line for each run of TetGen.

    Returns
    -------
    TetMesh
        Region 0 brain, 1 tumour. Its first points are those of the merged surfaces,
        sorted by (x, y, z).

    Raises
    ------
    InputError
        If tetgen is not installed, an option is out of range or TetGen fails.
    """
    if not tetgen_process.available():
        raise InputError(
            "meshing needs the tetgen package, which is not installed: "
            "run pip install 'physgnn[tetgen]'"
        )
    if not 1.0 < quality_ratio <= 10.0:
        raise InputError(f"quality_ratio must be in (1, 10] (got {quality_ratio})")
    if max_volume_mm3 is not None and target_points is not None:
        raise InputError("give max_volume_mm3 or target_points, not both")
    complex_ = merge([brain, *tumours])

    def mesh(max_volume: float) -> TetMesh:
        result = _run_tetgen(complex_, max_volume, quality_ratio)
        log(
            f"TetGen: {result.n_points} points, {result.n_cells} cells "
            f"(cells up to {max_volume:.4g} mm³)"
        )
        return result

    if target_points is not None:
        found = _mesh_near(target_points, mesh, paper_max_volume(complex_))
        if abs(np.log(found.n_points / target_points)) > TARGET_TOLERANCE:
            log(
                f"{found.n_points} points is the nearest to {target_points} found: the "
                f"{complex_.n_points} points of the surfaces are kept"
            )
        return found
    if max_volume_mm3 is None:
        return mesh(paper_max_volume(complex_))
    if not 0 < max_volume_mm3 < np.inf:
        raise InputError(f"max_volume_mm3 must be > 0 (got {max_volume_mm3})")
    return mesh(max_volume_mm3)


def paper_max_volume(surface: Surface) -> float:
    """Return the published bound on a cell's volume in mm³.

    Twice the volume of the regular tetrahedron, h³/(6√2), on the mean edge length h
    of the merged surfaces.

    Parameters
    ----------
    surface : Surface
        The merged surfaces; mm.

    Returns
    -------
    float
        mm³.
    """
    return float(2.0 * edge_lengths(surface).mean() ** 3 / (6.0 * np.sqrt(2.0)))


def _run_tetgen(surface: Surface, max_volume: float, quality_ratio: float) -> TetMesh:
    switches = f"pq{quality_ratio:g}Aa{max_volume:.10f}Y"
    try:
        points, cells, attribute = tetgen_process.run(
            surface.points, surface.faces, switches
        )
    except RuntimeError as error:
        raise InputError(
            f"TetGen could not mesh the surfaces (-{switches}): {error}; check them "
            "for faces that touch or cross, or coarsen them"
        ) from error
    return TetMesh(points, cells, _regions(cells, attribute))


def _regions(cells: FaceArray, attribute: FaceArray) -> FaceArray:
    """Return 0 for cells connected to the outside (brain), 1 for enclosed ones.

    TetGen numbers the regions in an order of its own.
    """
    faces = np.sort(cells[:, CELL_FACES], axis=2).reshape(-1, 3)
    _, first, count = np.unique(faces, axis=0, return_index=True, return_counts=True)
    outer = np.unique(attribute[first[count == 1] // 4])
    return (~np.isin(attribute, outer)).astype(np.int32)


def _mesh_near(
    target: int, mesh: Callable[[float], TetMesh], first_volume: float
) -> TetMesh:
    """Return the mesh nearest to a number of points within a few runs.

    Secant steps on log(points) over log(volume); points grow as 1/volume.
    """
    low, high = TARGET_RANGE
    if not low <= target <= high:
        raise InputError(f"target_points must be in {low}…{high} (got {target})")
    log_volume, slope = np.log(first_volume), -1.0
    tried: list[tuple[float, float, TetMesh]] = []
    for _ in range(TARGET_RUNS):
        found = mesh(float(np.exp(log_volume)))
        excess = float(np.log(found.n_points / target))
        tried.append((log_volume, excess, found))
        if abs(excess) < TARGET_TOLERANCE:
            break
        if len(tried) > 1:
            (x0, y0, _), (x1, y1, _) = tried[-2:]
            if abs(y1 - y0) < SATURATED:
                break
            slope = min((y1 - y0) / (x1 - x0), -0.1)
        log_volume -= np.clip(excess / slope, -4.0, 4.0)
    return min(tried, key=lambda run: abs(run[1]))[2]

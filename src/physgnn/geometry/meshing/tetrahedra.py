"""Surfaces to a two-region tetrahedral mesh, by TetGen as published or by fTetWild.

For TetGen the merged surfaces' points are sorted by (x, y, z) and kept exactly; it runs
with ``-pq1.2AaY``. Its result depends on its version and on that order: the tetgen
wheel carries TetGen 1.6. fTetWild is what is left where tetgen is not installed.
"""

from collections.abc import Callable, Sequence
from functools import partial
from importlib.metadata import version

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.cell_checks import CELL_FACES
from physgnn.geometry.meshing import tetgen_process
from physgnn.geometry.meshing.target_points import (
    TARGET_RUNS,
    Target,
    mesh_from_coarser,
    mesh_near,
)
from physgnn.geometry.meshing.tetwild import edge_of, mesh_by_tetwild
from physgnn.geometry.surface import FaceArray, Surface, edge_lengths, merge, volume
from physgnn.geometry.tetmesh import TetMesh

TETGEN, TETWILD = "tetgen", "tetwild"
# fTetWild takes twenty seconds where TetGen takes one
TARGET_TOLERANCE = {TETGEN: 0.05, TETWILD: 0.1}
# What fTetWild takes for a point, ms on one thread: even surfaces, and surfaces much
# finer than the cells.
TETWILD_MS = (1.0, 10.0)


def tetrahedralize(
    brain: Surface,
    tumours: Sequence[Surface] = (),
    *,
    max_volume_mm3: float | None = None,
    target_points: int | None = None,
    quality_ratio: float = 1.2,
    mesher: str | None = None,
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
    mesher : str, optional
        ``"tetgen"`` keeps the surfaces' points, ``"tetwild"`` moves them by up to 0.1
        mm for better cells; by default TetGen where it is installed.
    log : callable
        Gets one line for each run of the mesher.

    Returns
    -------
    TetMesh
        Region 0 brain, 1 tumour. TetGen's first points are those of the merged
        surfaces, sorted by (x, y, z).

    Raises
    ------
    InputError
        If tetgen is not installed, an option is out of range or TetGen fails.
    """
    chosen = chosen_mesher(mesher)
    if not 1.0 < quality_ratio <= 10.0:
        raise InputError(f"quality_ratio must be in (1, 10] (got {quality_ratio})")
    if max_volume_mm3 is not None and target_points is not None:
        raise InputError("give max_volume_mm3 or target_points, not both")
    complex_ = merge([brain, *tumours])
    fill = MESHERS[chosen](brain, tumours, quality_ratio)

    def mesh(max_volume: float) -> TetMesh:
        result = fill(max_volume)
        log(
            f"{NAMES[chosen]}: {result.n_points} points, {result.n_cells} cells "
            f"(cells up to {max_volume:.4g} mm³)"
        )
        return result

    if target_points is not None:
        first = _first_volume(chosen, brain, complex_, target_points)
        tolerance = TARGET_TOLERANCE[chosen]
        if chosen == TETWILD:
            on_surfaces = complex_.n_points
            log(_expected_seconds(max(target_points, on_surfaces)))
            target = Target(target_points, first, tolerance, on_surfaces)
            found = mesh_from_coarser(target, mesh)
        else:  # fast, and published meshes come from the plain search
            found = mesh_near(Target(target_points, first, tolerance), mesh)
        if abs(np.log(found.n_points / target_points)) > tolerance:
            log(_nearest(found, target_points, complex_, chosen))
        return found
    if max_volume_mm3 is None:
        return mesh(paper_max_volume(complex_))
    if not 0 < max_volume_mm3 < np.inf:
        raise InputError(f"max_volume_mm3 must be > 0 (got {max_volume_mm3})")
    return mesh(max_volume_mm3)


def chosen_mesher(mesher: str | None) -> str:
    """Return the mesher of a name, or the one that is there.

    Raises
    ------
    InputError
        If there is no such mesher, or it is TetGen and not installed.
    """
    if mesher is None:
        return TETGEN if tetgen_process.available() else TETWILD
    if mesher not in MESHERS:
        raise InputError(
            f"the mesher must be one of {', '.join(MESHERS)} (got '{mesher}')"
        )
    if mesher == TETGEN and not tetgen_process.available():
        raise InputError(
            "meshing by TetGen needs the tetgen package, which is not installed: "
            "run pip install 'physgnn[tetgen]', or mesh by fTetWild (--mesher tetwild)"
        )
    return mesher


def record(mesher: str) -> str:
    """Return what a mesh file says about its mesher.

    Parameters
    ----------
    mesher : str
        As `chosen_mesher` returns it.

    Returns
    -------
    str
        Name and version, and whether a second run gives the same mesh.
    """
    again, package = {
        TETGEN: ("another run gives the same mesh", "tetgen"),
        # it shuffles the triangles by random numbers of the system, and has no seed
        TETWILD: ("another run gives other points", "pytetwild"),
    }[mesher]
    return f"{NAMES[mesher]} (package {package} {version(package)}); {again}"


def _nearest(found: TetMesh, wanted: int, surfaces: Surface, mesher: str) -> str:
    reason = "are kept" if mesher == TETGEN else "ask for theirs"
    return (
        f"{found.n_points} points is the nearest to {wanted} found: the "
        f"{surfaces.n_points} points of the surfaces {reason}"
    )


def _expected_seconds(n_points: int) -> str:
    low, high = (n_points * ms / 1000.0 for ms in TETWILD_MS)
    return (
        f"fTetWild: {low:.0f} to {high:.0f} s of one core a run for {n_points} points, "
        f"and up to {TARGET_RUNS} runs to meet their number"
    )


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


Filler = Callable[[float], TetMesh]


def _tetgen(brain: Surface, tumours: Sequence[Surface], quality_ratio: float) -> Filler:
    return partial(_run_tetgen, merge([brain, *tumours]), quality_ratio=quality_ratio)


def _tetwild(brain: Surface, tumours: Sequence[Surface], _: float) -> Filler:
    return lambda max_volume: mesh_by_tetwild(brain, tumours, edge_of(max_volume))


MESHERS: dict[str, Callable[[Surface, Sequence[Surface], float], Filler]] = {
    "tetwild": _tetwild,
    "tetgen": _tetgen,
}
NAMES = {TETGEN: "TetGen", TETWILD: "fTetWild"}
# Points of fTetWild's mesh for those of a lattice of the edge that is asked for.
TETWILD_POINTS = 1.38


def _first_volume(mesher: str, brain: Surface, whole: Surface, target: int) -> float:
    """Return the cell volume that a search for a number of points begins with."""
    if mesher == TETGEN:
        return paper_max_volume(whole)
    # a lattice of edge h has a point for every h³/√2, so a bound of 2h³/(6√2) has
    return float(TETWILD_POINTS * abs(volume(brain)) / (3.0 * target))


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

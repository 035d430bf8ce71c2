"""Results as a folder of VTU or VTK files, one a load level, in the order of names.

Every file holds the mesh at rest (cell array ``region``; point set ``fixed``, see
`physgnn.io.vtk.vtu`, or point array ``in_fixed``) and two point arrays:
``displacement_mm`` and ``force_n``, the nodal forces at that level. Field data
``load_factor`` says the level's; without it the last level's is 1 and the others'
follow from the forces.
"""

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.integrity.atomic import whole_folder
from physgnn.io.simulation import Simulation, solution_of
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.numbers import real_numbers
from physgnn.io.vtk.data import VtkData
from physgnn.io.vtk.reader import read_vtk
from physgnn.io.vtk.vtu import grid_of, mesh_of, save_grid
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.loads.paths import LoadPath

SUFFIXES = (".vtu", ".vtk")
DISPLACEMENT, FORCE, FACTOR = "displacement_mm", "force_n", "load_factor"
PROPORTIONAL = 1e-6  # of the largest force: files may hold single precision


def read_series(folder: Path) -> list[Simulation]:
    """Read a load path from a folder.

    Raises
    ------
    InputError
        If there are no such files, an array is missing, the mesh or the loaded points
        change on the way, or the forces do not grow in proportion.
    """
    files = sorted(
        (f for f in folder.iterdir() if f.suffix in SUFFIXES), key=_by_number
    )
    if not files:
        raise InputError(f"{folder}: holds no .vtu or .vtk files, one a load level")
    first = _read(files[0], mesh_of)
    force = np.stack(
        [_read(file, partial(_vectors, name=FORCE, mesh=first)) for file in files]
    )
    factors = _factors(files, force)
    last = force[-1] / factors[-1]
    off = np.abs(force - factors[:, None, None] * last).max(axis=(1, 2))
    if (off > PROPORTIONAL * np.abs(last).max()).any():
        raise InputError(
            f"{files[int(off.argmax())]}: its '{FORCE}' must be a multiple of the last "
            "file's"
        )
    nodes = np.flatnonzero(last.any(axis=1))
    try:
        load_path = LoadPath(nodes, last[nodes], factors)
    except InputError as error:
        raise InputError(f"{folder}: {error}") from error
    fixed = _read(files[0], _fixed)
    read = partial(_solution, files, first, factors)
    return [Simulation(str(folder), first, fixed, load_path, None, read)]


def write_series(folder: str | Path, simulation: Simulation) -> None:
    """Write the converged levels of a load path; `read_series` gives them back.

    A path with other loads than nodal forces is written without forces, to be looked
    at: `read_series` refuses it.

    Raises
    ------
    InputError
        If the folder exists already.
    """
    mesh = simulation.mesh.with_point_sets(fixed=simulation.fixed)
    solution = simulation.read_solution()
    with whole_folder(Path(folder)) as part:
        part.mkdir()
        for level in np.flatnonzero(solution.status == Status.CONVERGED).tolist():
            grid = grid_of(mesh)
            grid.point_data[DISPLACEMENT] = solution.displacement[level]
            if not simulation.load_path.more:  # part of the loads would pass for all
                case = simulation.load_path.case(level)
                grid.point_data[FORCE] = case.on_points(mesh.n_points)
            grid.field_data[FACTOR] = [simulation.load_path.load_factors[level]]
            save_grid(part / f"level-{level:04d}.vtu", grid)


def _solution(files: list[Path], mesh: TetMesh, factors: FloatArray) -> Solution:
    take = partial(_vectors, name=DISPLACEMENT, mesh=mesh)
    return solution_of(np.stack([_read(file, take) for file in files]), factors)


def _read(file: Path, take: Callable[[VtkData], Any]) -> Any:
    """Read a file and take something of it; what is wrong names the file."""
    with reading(file, "a load level"):
        return take(read_vtk(file))


def _vectors(grid: VtkData, name: str, mesh: TetMesh) -> FloatArray:
    """Return a point array, once the points are known to be the mesh's."""
    if grid.n_points != mesh.n_points:
        raise InputError(f"has {grid.n_points} points, the first file {mesh.n_points}")
    if not np.array_equal(grid.points, mesh.points):
        raise InputError(
            "its points are not the first file's: write the mesh at rest, not deformed"
        )
    if name not in grid.point_data:
        have = ", ".join(grid.point_data) or "none"
        raise InputError(f"needs a point array '{name}' (it has: {have})")
    values = real_numbers(grid.point_data[name], f"'{name}'")
    if values.shape != (mesh.n_points, 3):
        raise InputError(f"'{name}' must be vectors (got shape {values.shape})")
    return values


def _fixed(grid: VtkData) -> IntArray:
    mesh = mesh_of(grid)
    if "fixed" not in mesh.point_sets and "in_fixed" in grid.point_data:
        return np.flatnonzero(grid.point_data["in_fixed"])
    return mesh.point_set("fixed")


def _factors(files: list[Path], force: FloatArray) -> FloatArray:
    said = [_read(file, _load_factor) for file in files]
    if None not in said:
        return np.array(said, dtype=np.float64)
    along = force.reshape(len(force), -1) @ force[-1].ravel()
    # Not by the last's own product with itself: that may differ by a rounding error,
    # and the last factor is to be 1.
    factors: FloatArray = along / along[-1]
    return factors


def _load_factor(grid: VtkData) -> float | None:
    return float(grid.field_data[FACTOR][0]) if FACTOR in grid.field_data else None


def _by_number(file: Path) -> list[tuple[int, str]]:
    """Sort u-9 before u-10: runs of digits count as numbers."""
    parts = re.split(r"(\d+)", file.stem)
    return [(int(p), "") if p.isdecimal() else (-1, p) for p in parts]

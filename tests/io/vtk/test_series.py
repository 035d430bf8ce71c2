"""A folder of VTU or VTK files, ours and another program's."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.simulation import Simulation, solution_of
from physgnn.io.vtk.series import read_series, write_series
from physgnn.mechanics.loads.paths import LoadPath

FACTORS = np.array([0.1, 0.4, 0.75])


@pytest.fixture
def simulation(block: TetMesh) -> Simulation:
    top = block.point_set("loaded")[:3]
    displacement = np.random.default_rng(0).normal(size=(3, block.n_points, 3))
    path = LoadPath(top, np.arange(9.0).reshape(3, 3) / 7, FACTORS)
    fixed = block.point_set("fixed")
    solution = solution_of(displacement, FACTORS)
    return Simulation("made up", block, fixed, path, None, lambda: solution)


def test_round_trip(simulation: Simulation, tmp_path: Path) -> None:
    write_series(tmp_path / "path", simulation)
    (again,) = read_series(tmp_path / "path")
    assert again.mesh.content_hash == simulation.mesh.content_hash
    assert np.array_equal(again.fixed, simulation.fixed)
    assert np.array_equal(again.load_path.nodes, simulation.load_path.nodes)
    assert np.allclose(again.load_path.forces, simulation.load_path.forces, rtol=1e-15)
    assert np.array_equal(again.load_path.load_factors, FACTORS)
    expected = simulation.read_solution().displacement
    assert np.array_equal(again.read_solution().displacement, expected)


def elsewhere(
    folder: Path, simulation: Simulation, change: Callable[[int, pv.DataSet], None]
) -> None:
    """Write as another program would: legacy VTK, no field data, unpadded names."""
    folder.mkdir()
    solution, mesh = simulation.read_solution(), simulation.mesh
    for level in range(3):
        grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
        grid.cell_data["region"] = mesh.region
        grid.point_data["in_fixed"] = (
            np.isin(range(mesh.n_points), simulation.fixed) * 1
        )
        grid.point_data["displacement_mm"] = solution.displacement[level]
        force = simulation.load_path.case(level).on_points(mesh.n_points)
        grid.point_data["force_n"] = force
        change(level, grid)
        grid.save(folder / f"u{8 + level}.vtk")


def test_of_another_program(simulation: Simulation, tmp_path: Path) -> None:
    """Its last level is load factor 1."""
    elsewhere(tmp_path / "path", simulation, lambda *_: None)
    (again,) = read_series(tmp_path / "path")
    assert np.array_equal(np.sort(again.fixed), np.sort(simulation.fixed))
    assert np.allclose(again.load_path.load_factors, FACTORS / 0.75, rtol=1e-14)
    forces = simulation.load_path.forces * 0.75
    assert np.allclose(again.load_path.forces, forces, rtol=1e-14)
    expected = simulation.read_solution().displacement
    assert np.array_equal(again.read_solution().displacement, expected)


def drop(name: str) -> Callable[[int, pv.DataSet], None]:
    return lambda _, grid: grid.point_data.remove(name)


def turn(level: int, grid: pv.DataSet) -> None:
    grid.point_data["force_n"] = np.roll(grid.point_data["force_n"], level, axis=1)


def reverse(level: int, grid: pv.DataSet) -> None:
    grid.point_data["force_n"] = grid.point_data["force_n"] / (1 + level) ** 4


def deform(level: int, grid: pv.DataSet) -> None:
    grid.points = grid.points + 0.1 * level


def refine(level: int, grid: pv.DataSet) -> None:
    if level == 1:
        grid.copy_from(pv.UnstructuredGrid(pv.examples.cells.Tetrahedron()))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (drop("force_n"), "u8.vtk: needs a point array 'force_n' (it has: in_fixed"),
        (drop("displacement_mm"), "u8.vtk: needs a point array 'displacement_mm'"),
        (drop("in_fixed"), "the mesh has no point set 'fixed'"),
        (turn, "its 'force_n' must be a multiple of the last file's"),
        (reverse, "load_factors must increase strictly"),
        (deform, "u9.vtk: its points are not the first file's"),
        (refine, "u9.vtk: has 4 points, the first file 64"),
        (
            lambda _, g: g.cell_data.remove("region"),
            "u8.vtk: needs a cell array 'region'",
        ),
    ],
)
def test_what_does_not_fit(
    simulation: Simulation,
    tmp_path: Path,
    change: Callable[[int, pv.DataSet], None],
    message: str,
) -> None:
    elsewhere(tmp_path / "path", simulation, change)
    with pytest.raises(InputError) as error:
        read_series(tmp_path / "path")[0].read_solution()
    assert message in str(error.value)


def test_empty_and_full(simulation: Simulation, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"holds no \.vtu or \.vtk files"):
        read_series(tmp_path)
    with pytest.raises(InputError, match="exists already"):
        write_series(tmp_path, simulation)


def test_nothing_is_left_of_what_failed(simulation: Simulation, tmp_path: Path) -> None:
    def pending() -> None:
        raise InputError("no result yet")

    with pytest.raises(InputError, match="no result yet"):
        write_series(tmp_path / "path", replace(simulation, read_solution=pending))
    assert list(tmp_path.iterdir()) == []

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from hypothesis import given
from hypothesis import strategies as st

from physgnn.errors import InputError
from physgnn.geometry import TetMesh
from physgnn.io import read_mesh, write_mesh, write_prediction
from physgnn.io.vtk.vtu import add_notes


def assert_same(one: TetMesh, other: TetMesh) -> None:
    assert one.content_hash == other.content_hash
    assert set(one.point_sets) == set(other.point_sets)
    for name, ids in one.point_sets.items():
        np.testing.assert_array_equal(other.point_set(name), ids)
        assert other.point_set(name).dtype == np.int64


@given(seed=st.integers(0, 1000), scale=st.floats(0.5, 50.0))
def test_round_trip_is_exact(
    tmp_path_factory: pytest.TempPathFactory, block: TetMesh, seed: int, scale: float
) -> None:
    random = np.random.default_rng(seed)
    mesh = TetMesh(
        points=scale * block.points + random.normal(),
        cells=block.cells[random.permutation(block.n_cells)],
        region=random.integers(0, 3, block.n_cells),
        point_sets={
            "fixed": block.point_set("fixed"),
            "in an order of its own": random.permutation(block.n_points)[:7],
            "empty": np.array([], dtype=np.int64),
        },
    )
    points, sets = mesh.points.copy(), {k: v.copy() for k, v in mesh.point_sets.items()}
    path = tmp_path_factory.mktemp("vtu") / "case.vtu"
    write_mesh(path, mesh)
    assert_same(mesh, read_mesh(path))
    np.testing.assert_array_equal(mesh.points, points)
    for name, ids in sets.items():
        np.testing.assert_array_equal(mesh.point_set(name), ids)


def test_other_programs_see_regions_and_sets(tmp_path: Path, block: TetMesh) -> None:
    write_mesh(tmp_path / "case.vtu", block)
    grid = pv.read(tmp_path / "case.vtu")
    np.testing.assert_array_equal(grid.cell_data["region"], block.region)
    inside = np.flatnonzero(grid.point_data["in_fixed"])
    np.testing.assert_array_equal(inside, block.point_set("fixed"))
    assert grid.compute_cell_sizes()["Volume"].sum() == pytest.approx(1000.0)


def test_prediction_carries_its_fields_and_the_mesh(
    tmp_path: Path, block: TetMesh
) -> None:
    displacement = np.random.default_rng(0).normal(size=(block.n_points, 3))
    error = np.linspace(0, 1, block.n_points)
    fields = {"displacement_mm": displacement, "error_mm": error}
    write_prediction(tmp_path / "p.vtu", block, fields)
    grid = pv.read(tmp_path / "p.vtu")
    for name, values in fields.items():
        np.testing.assert_array_equal(grid.point_data[name], values)
    assert_same(block, read_mesh(tmp_path / "p.vtu"))


def test_fields_of_another_shape_leave_no_file(tmp_path: Path, block: TetMesh) -> None:
    with pytest.raises(InputError, match="'u' must have one value or vector a point"):
        write_prediction(tmp_path / "p.vtu", block, {"u": np.zeros((3, 3))})
    assert list(tmp_path.iterdir()) == []


def test_names_and_folders(tmp_path: Path, block: TetMesh) -> None:
    with pytest.raises(InputError, match=r"written as \.vtu"):
        write_mesh(tmp_path / "case.stl", block)
    with pytest.raises(InputError, match="is not there"):
        write_mesh(tmp_path / "no" / "case.vtu", block)
    with pytest.raises(InputError, match="no such file"):
        read_mesh(tmp_path / "case.vtu")


def test_the_case_of_letters_does_not_matter(tmp_path: Path, block: TetMesh) -> None:
    write_mesh(tmp_path / "CASE.VTU", block)
    assert read_mesh(tmp_path / "CASE.VTU").content_hash == block.content_hash


def test_a_mesh_in_another_unit_is_refused_or_told(
    tmp_path: Path, block: TetMesh
) -> None:
    path, said = tmp_path / "case.vtu", list[str]()
    for factor, unit in ((1e-3, "metres"), (1e3, "micrometres")):
        write_mesh(path, replace(block, points=factor * block.points))
        with pytest.raises(InputError, match=f"case.vtu.* must be in mm .*{unit}"):
            read_mesh(path)
    write_mesh(path, block)  # 1 ml
    assert_same(read_mesh(path, log=said.append), block)
    assert "1 ml, and that of a brain if its coordinates are in centimetres" in said[0]


def test_files_that_are_no_mesh_of_ours(
    tmp_path: Path, block: TetMesh, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "case.vtu"
    write_mesh(path, block)
    whole = path.read_bytes()
    for content in (b"", b"hello", np.random.default_rng(0).bytes(999), whole[:-900]):
        path.write_bytes(content)
        with pytest.raises(InputError) as caught:
            read_mesh(path)
        assert str(caught.value).startswith(str(path))
        assert "\n" not in str(caught.value)
    assert capfd.readouterr().err == ""


def test_cells_of_another_kind_and_missing_regions(
    tmp_path: Path, block: TetMesh
) -> None:
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: block.cells}, block.points.copy())
    grid.save(tmp_path / "no-region.vtu")
    with pytest.raises(InputError, match=r"needs a cell array 'region'.*none"):
        read_mesh(tmp_path / "no-region.vtu")
    pv.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid().save(
        tmp_path / "boxes.vtu"
    )
    with pytest.raises(InputError, match="linear tetrahedron"):
        read_mesh(tmp_path / "boxes.vtu")
    grid.cell_data["region"] = block.region
    grid.points[block.cells[0, 0]] += 100.0
    grid.save(tmp_path / "inverted.vtu")
    with pytest.raises(InputError, match=r"inverted\.vtu: cells must have positive"):
        read_mesh(tmp_path / "inverted.vtu")


def test_notes_of_any_alphabet_are_written(tmp_path: Path, block: TetMesh) -> None:
    """A reason with a degree sign, or a user's label, once ended in an error."""
    grid = pv.PolyData(block.points)
    add_notes(grid, {"reasons": ["20° off", "Schädel: 脳", "plain"], "none": []})
    grid.save(tmp_path / "notes.vtp")
    back = pv.read(tmp_path / "notes.vtp").field_data
    kept = [line.encode().decode("unicode_escape") for line in back["reasons"]]
    assert kept == ["20° off", "Schädel: 脳", "plain"]
    assert "none" not in back

"""Our reader of VTK's XML against VTK's own, in every way that VTK writes."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista as pv
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.vtk.data import VtkData
from physgnn.io.vtk.isolated import VtkProcess, read_isolated
from physgnn.io.vtk.reader import read_vtk
from physgnn.io.vtk.vtu import grid_of
from physgnn.io.vtk.xml_arrays import OtherFeatureError
from physgnn.io.vtk.xml_reader import read_vtk_xml

WAYS = [
    (mode, compressor, word, order, encode)
    for mode in ("ascii", "binary", "appended")
    for compressor in ("none", "zlib")
    for word in (32, 64)
    for order in ("little", "big")
    for encode in (True, False)
    if mode == "appended" or (encode and (mode != "ascii" or compressor == "none"))
]


def write(writer: Any, path: Path, data: pv.DataSet, way: tuple[Any, ...]) -> Path:
    mode, compressor, word, order, encode = way
    getattr(writer, f"SetDataModeTo{mode.capitalize()}")()
    getattr(writer, f"SetCompressorTypeTo{COMPRESSORS[compressor]}")()
    getattr(writer, f"SetHeaderTypeToUInt{word}")()
    getattr(writer, f"SetByteOrderTo{order.capitalize()}Endian")()
    writer.SetEncodeAppendedData(encode)
    writer.SetBlockSize(64)  # many blocks, and a last one that is smaller
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    assert writer.Write()
    return path


COMPRESSORS = {"none": "None", "zlib": "ZLib", "lz4": "LZ4"}


def check(found: VtkData, grid: pv.UnstructuredGrid) -> None:
    np.testing.assert_array_equal(found.points, grid.points)
    np.testing.assert_array_equal(found.connectivity, grid.cell_connectivity)
    np.testing.assert_array_equal(np.diff(found.offsets), 4)
    np.testing.assert_array_equal(found.cell_types, grid.celltypes)
    for ours, theirs in (
        (found.point_data, grid.point_data),
        (found.cell_data, grid.cell_data),
        (found.field_data, grid.field_data),
    ):
        assert sorted(ours) == sorted(theirs.keys())
        for name, values in ours.items():
            np.testing.assert_array_equal(values, np.asarray(theirs[name]))


@pytest.fixture
def grid(block: TetMesh) -> pv.UnstructuredGrid:
    grid = grid_of(block)
    grid.point_data["u"] = np.random.default_rng(0).normal(size=(block.n_points, 3))
    grid.point_data["small"] = np.arange(block.n_points, dtype=np.int8)
    grid.field_data["nothing"] = np.empty(0)
    return grid


@pytest.mark.parametrize("way", WAYS, ids=lambda way: "-".join(map(str, way)))
def test_every_way_of_writing(
    way: tuple[Any, ...], grid: pv.UnstructuredGrid, tmp_path: Path
) -> None:
    path = write(vtkXMLUnstructuredGridWriter(), tmp_path / "a.vtu", grid, way)
    check(read_vtk_xml(path), grid)


def test_what_only_vtk_reads_is_read_apart(
    grid: pv.UnstructuredGrid, tmp_path: Path
) -> None:
    way = ("appended", "lz4", 32, "little", True)
    path = write(vtkXMLUnstructuredGridWriter(), tmp_path / "a.vtu", grid, way)
    with pytest.raises(OtherFeatureError):
        read_vtk_xml(path)
    check(read_vtk(path), grid)
    grid.save(tmp_path / "a.vtk")
    check(read_vtk(tmp_path / "a.vtk"), grid)


def test_polygons_and_strips(tmp_path: Path) -> None:
    points = np.random.default_rng(1).normal(size=(9, 3))
    faces = np.array([4, 0, 1, 2, 3, 3, 3, 4, 5])
    data = pv.PolyData(points, faces=faces, strips=np.array([4, 5, 6, 7, 8]))
    way = ("binary", "zlib", 32, "little", True)
    path = write(vtkXMLPolyDataWriter(), tmp_path / "a.vtp", data, way)
    for found in (read_vtk_xml(path), read_isolated(path)):
        np.testing.assert_allclose(found.points, points)
        np.testing.assert_array_equal(found.offsets, [0, 4, 7, 11])
        np.testing.assert_array_equal(
            found.connectivity, [0, 1, 2, 3, 3, 4, 5, 5, 6, 7, 8]
        )
        np.testing.assert_array_equal(found.cell_types, [7, 7, 6])


def test_a_reader_that_crashes_or_hangs_harms_nobody(
    grid: pv.UnstructuredGrid, tmp_path: Path
) -> None:
    grid.save(tmp_path / "a.vtk")
    hurried = VtkProcess(timeout_s=1e-3)
    with pytest.raises(InputError, match=r"took more than 0\.001 s"):
        hurried.read(tmp_path / "a.vtk")
    process = VtkProcess()
    check(process.read(tmp_path / "a.vtk"), grid)
    assert process._reader._process is not None
    process._reader._process.kill()  # as a crash leaves it
    process._reader._process.wait()
    check(process.read(tmp_path / "a.vtk"), grid)
    process.close()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('NumberOfPoints="64"', 'NumberOfPoints="6400000000"'),
        ('NumberOfCells="162"', 'NumberOfCells="-1"'),
        ('header_type="UInt32"', 'header_type="UInt64"'),
        ('Name="offsets"', 'Name="other"'),
        ('type="Float64"', 'type="Int16"'),
    ],
)
def test_declarations_that_do_not_fit(
    old: str, new: str, grid: pv.UnstructuredGrid, tmp_path: Path
) -> None:
    way = ("binary", "zlib", 32, "little", True)
    path = write(vtkXMLUnstructuredGridWriter(), tmp_path / "a.vtu", grid, way)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError, match=r"a\.vtu"):
        read_vtk(path)

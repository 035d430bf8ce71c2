"""Meshes of VTK, Gmsh, Abaqus, Medit and OFF, as arrays that have been checked."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from physgnn.arrays import IntArray
from physgnn.errors import InputError
from physgnn.imaging.transforms import points_to_ras
from physgnn.io.meshes import meshio_process
from physgnn.io.untrusted.isolated import Arrays, IsolatedReader
from physgnn.io.untrusted.numbers import whole_numbers
from physgnn.io.vtk.data import VtkData
from physgnn.io.vtk.reader import read_vtk
from physgnn.io.vtk.vtu import SET_PREFIX

BY_MESHIO = tuple(meshio_process.READERS)
BY_VTK = (".vtk", ".vtu")
HEAD_BYTES = 4096
TRIANGLE, QUAD, POLYGON, STRIP = 5, 9, 7, 6

_READER = IsolatedReader(meshio_process.__file__, "meshio")


@dataclass(frozen=True, eq=False)
class MeshFile:
    """What a mesh file holds.

    Attributes
    ----------
    data : VtkData
        Points in RAS+, cells and their arrays.
    names : mapping of array to (number to name)
        What the file calls the numbers in a cell array.
    point_sets : mapping of str to integer array
        Named sets of points.
    """

    data: VtkData
    names: Mapping[str, Mapping[int, str]] = field(default_factory=dict)
    point_sets: Mapping[str, IntArray] = field(default_factory=dict)


def read_mesh_file(path: Path) -> MeshFile:
    """Read the cells of a mesh of any of these formats.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    if path.suffix.lower() in BY_VTK:
        data = _in_ras(path, read_vtk(path))
        sets = {
            name.removeprefix(SET_PREFIX): whole_numbers(values, f"'{name}'")
            for name, values in data.field_data.items()
            if name.startswith(SET_PREFIX)
        }
        return MeshFile(data, point_sets=sets)
    return _of_meshio(_READER.read(path))


def _in_ras(path: Path, data: VtkData) -> VtkData:
    """Turn what says that it is in LPS, as models of 3D Slicer do."""
    with path.open("rb") as file:
        said = "LPS" if b"SPACE=LPS" in file.read(HEAD_BYTES) else "RAS"
    if "SPACE" in data.field_data and len(data.field_data["SPACE"]):
        said = str(data.field_data["SPACE"][0])
    return replace(data, points=points_to_ras(data.points, said))


def _of_meshio(arrays: Arrays) -> MeshFile:
    text = json.loads(arrays["text"].tobytes())
    blocks = [arrays[f"cells_{i}"] for i in range(len(text["types"]))]
    lengths = [np.full(len(block), block.shape[1]) for block in blocks]
    sets = {
        name: whole_numbers(arrays[f"set_{i}"], f"point set '{name}'")
        for i, name in enumerate(text["sets"])
    }
    data = VtkData(
        points=arrays["points"],
        connectivity=np.concatenate(
            [np.empty(0, np.int64), *(b.ravel() for b in blocks)]
        ),
        offsets=np.concatenate([[0], np.cumsum(np.concatenate([[], *lengths]))]),
        cell_types=np.repeat(text["types"], [len(block) for block in blocks]),
        cell_data={n: arrays[f"array_{i}"] for i, n in enumerate(text["arrays"])},
    )
    names = {
        array: {int(number): name for number, name in of.items()}
        for array, of in text["names"].items()
    }
    return MeshFile(data, names, sets)

"""Every kind of file that we read: how to make a small valid one, and how it is read.

A new format gets a row here, and mutants and flipped bits are tried on it by itself.
"""

import contextlib
import gzip
import io
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import meshio
import nibabel as nib
import numpy as np
import pyvista as pv
import SimpleITK as sitk

from dicom_files import write_series
from meshes import block_mesh
from physgnn.config import read_materials, read_point_sets, read_preset
from physgnn.geometry.image import Image, LabelVolume
from physgnn.imaging.transforms import to_itk
from physgnn.io import read_load_case, read_mesh, read_surface, write_prediction
from physgnn.io.array_files import read_arrays, write_arrays
from physgnn.io.febio.log import read_febio_log
from physgnn.io.febio.model_reader import read_febio
from physgnn.io.febio.model_writer import write_febio
from physgnn.io.medical.images.formats import read_image, read_segmentation, write_image
from physgnn.io.medical.markups import read_point_pairs
from physgnn.io.medical.measured_surface import read_surface_points
from physgnn.io.meshes.tetrahedra import read_tetrahedra
from physgnn.io.simulation import Simulation, solution_of
from physgnn.io.vtk.prediction_file import read_displacement
from physgnn.io.vtk.reader import read_vtk
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean

MESH = block_mesh(2)
U = np.random.default_rng(0).normal(size=(MESH.n_points, 3))
FACTORS = np.array([0.5, 1.0])
PATH = LoadPath(MESH.point_set("loaded")[:2], np.ones((2, 3)), FACTORS)
AFFINE = np.diag([-2.0, 2.0, 2.0, 1.0])
SPHERE = pv.Icosphere(radius=10.0, nsub=1)
PAIRS = np.random.default_rng(1).normal(size=(4, 6))

TOML = """\
[point_sets.fixed]
kind = "complement"
of = { kind = "sphere", centre_mm = [44.0, 10.0, 66.0], radius_mm = 70 }

[point_sets.loaded]
kind = "nearest"
point_mm = [44.0, 10.0, 66.0]
count = 20

[materials.brain]
youngs_modulus_pa = 3000
poissons_ratio = 0.49

[loads]
total_force_n = 2.0
cone_deg = 30
paths = 4
levels = 5
"""
LOG = "*Step = 1\n*Time = 0.5\n*Data = ux;uy;uz\n1 0 0 0\n2 7 8 9e-3\n"
OBJ = "# made by é\no ball\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\n" + (
    "f 1//1 3//1 2//1\nf 1 2 4\nf -4 -1 -2\nf 2 3 4\n"
)
PLY = (
    "ply\nformat ascii 1.0\ncomment é\nelement vertex 4\nproperty float x\n"
    "property float y\nproperty float z\nelement face 2\n"
    "property list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n4 0 1 3 2\n"
)


@dataclass(frozen=True)
class FileFormat:
    """A kind of file.

    Attributes
    ----------
    name : str
        What its files are called.
    make : callable
        Writes a small valid file.
    read : callable
        Reads it, as the commands do.
    compressed : bool
        Whether a checksum covers its content.
    isolated : bool
        Whether it is parsed in another process.
    """

    name: str
    make: Callable[[Path], Any]
    read: Callable[[Path], Any]
    compressed: bool = False
    isolated: bool = False


def _text(content: str) -> Callable[[Path], Any]:
    return lambda path: path.write_text(content, "utf-8")


def _labels(path: Path) -> None:
    data = np.zeros((6, 7, 8), np.int32)
    data[1:5, 2:6, 2:7] = np.arange(80).reshape(4, 4, 5) // 40 + 1
    write_image(path, LabelVolume(data, AFFINE))


def _big_endian(path: Path) -> None:
    data = np.random.default_rng(2).normal(size=(4, 5, 6))
    header = nib.Nifti1Header(endianness=">")
    nib.save(nib.Nifti1Image(data.astype(">f4"), AFFINE, header), path)


def _layers(path: Path) -> None:
    data = np.zeros((2, 6, 7, 8), np.uint8)
    data[0, 1:5, 2:6, 2:7] = 1
    data[1, 2:4, 3:5, 3:5] = 2
    head = (
        "NRRD0004\ntype: uint8\ndimension: 4\nspace: left-posterior-superior\n"
        "sizes: 2 6 7 8\nspace directions: none (2,0,0) (0,2,0) (0,0,2)\n"
        "kinds: list domain domain domain\nencoding: gzip\nspace origin: (1,2,3)\n"
        "Segment0_Name:=brain\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n"
        "Segment1_Name:=tumour\nSegment1_LabelValue:=2\nSegment1_Layer:=1\n\n"
    )
    path.write_bytes(head.encode() + gzip.compress(data.tobytes(order="F")))


def _raw(path: Path) -> None:
    data = np.random.default_rng(2).integers(0, 900, size=(4, 5, 6)).astype(np.int16)
    sitk.WriteImage(to_itk(Image(data, AFFINE)), str(path))


def _dicom(path: Path) -> None:
    data = np.random.default_rng(2).integers(0, 900, size=(4, 5, 6))
    files = write_series(path.parent, Image(data, AFFINE))
    files[2].replace(path)


def _meshio(form: str) -> Callable[[Path], Any]:
    faces = [("triangle", SPHERE.regular_faces)]
    return _by_meshio(meshio.Mesh(np.asarray(SPHERE.points, float), faces), form)


def _tetrahedra(form: str) -> Callable[[Path], Any]:
    groups = {"gmsh:physical": [MESH.region + 1], "gmsh:geometrical": [MESH.region + 1]}
    made = meshio.Mesh(MESH.points, [("tetra", MESH.cells)], cell_data=groups)
    return _by_meshio(made, form)


def _by_meshio(made: meshio.Mesh, form: str) -> Callable[[Path], Any]:
    def write(path: Path) -> None:
        with contextlib.redirect_stderr(io.StringIO()):  # its warnings
            meshio.write(path, made, file_format=form)

    return write


def _tag(path: Path) -> None:
    rows = [" ".join(map(str, row)) + ' "p"' for row in PAIRS.tolist()]
    text = "MNI Tag Point File\nVolumes = 2;\n% a comment\n\nPoints =\n"
    path.write_text(text + "\n".join(rows) + ";\n")


def _stl(path: Path) -> None:
    pv.Icosphere(radius=10.0, nsub=1).save(path, binary=False)


def _grid(path: Path) -> None:
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: MESH.cells}, MESH.points)
    grid.cell_data["region"] = MESH.region
    grid.point_data["displacement_mm"] = U
    grid.save(path, binary=path.stem != "ascii")


def _prediction(path: Path) -> None:
    write_prediction(path, MESH, {"displacement_mm": U})


def _arrays(path: Path) -> None:
    solution = solution_of(np.stack([U, 2 * U]), FACTORS)
    fixed = MESH.point_set("fixed")
    write_arrays(path, [Simulation("", MESH, fixed, PATH, None, lambda: solution)] * 2)


def _squeezed(path: Path) -> None:
    _arrays(path.with_name("plain.npz"))
    with np.load(path.with_name("plain.npz")) as arrays:
        np.savez_compressed(path, **arrays)


def _febio(path: Path) -> None:
    materials = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.45)}
    fixed = MESH.point_set("fixed")
    write_febio(path, Body(MESH, materials, fixed), PATH)


def _csv(path: Path) -> None:
    np.savetxt(path, PAIRS, delimiter=",")


def _fcsv(path: Path) -> None:
    head = "# Markups fiducial file version = 5.6\n# CoordinateSystem = LPS\n"
    rows = [
        f"{i},{x},{y},{z},0,0,0,1,1,1,0,P{i},,,2,0\n"
        for i, (x, y, z) in enumerate(PAIRS[:, :3])
    ]
    path.write_text(head + "".join(rows))


def _mrk(path: Path) -> None:
    lists = [
        {
            "coordinateSystem": "LPS",
            "coordinateUnits": "mm",
            "controlPoints": [
                {"label": f"P{i}", "position": p, "positionStatus": "defined"}
                for i, p in enumerate(points.tolist())
            ],
        }
        for points in (PAIRS[:, :3], PAIRS[:, 3:])
    ]
    path.write_text(json.dumps({"markups": lists}))


def _load_case(path: Path) -> None:
    path.write_text(json.dumps({"nodes": [3, 4], "forces_n": [[0, 0, 1], [1, 0, 0]]}))


def _read_log(path: Path) -> Any:
    load = LoadPath([0], [[0.0, 0.0, 1.0]], FACTORS)
    return read_febio_log(path, load, times=FACTORS, node_ids=np.array([1, 2]))


def _read_arrays(path: Path) -> Any:
    return [simulation.read_solution() for simulation in read_arrays(path)]


def _read_toml(path: Path) -> Any:
    return read_point_sets(path), read_materials(path), read_preset(path)


FORMATS: Mapping[str, FileFormat] = {
    row.name: row
    for row in (
        FileFormat("labels.nii", _labels, read_segmentation),
        FileFormat("labels.nii.gz", _labels, read_segmentation, compressed=True),
        FileFormat("big.nii", _big_endian, read_image),
        FileFormat("a.nrrd", _labels, read_image),
        FileFormat("a.seg.nrrd", _labels, read_segmentation),
        FileFormat("layers.seg.nrrd", _layers, read_segmentation),
        FileFormat("a.mha", _labels, read_segmentation),
        FileFormat("a.mhd", _labels, read_segmentation),
        FileFormat("raw.mha", _raw, read_image),
        FileFormat("a.mgz", _labels, read_segmentation, compressed=True),
        FileFormat("a.mgh", _labels, read_image),
        FileFormat("a.dcm", _dicom, read_image, isolated=True),
        FileFormat("a.gipl", _raw, read_image, isolated=True),
        FileFormat("binary.stl", SPHERE.save, read_surface),
        FileFormat("ascii.stl", _stl, read_surface),
        FileFormat("ascii.ply", _text(PLY), read_surface),
        FileFormat("binary.ply", SPHERE.save, read_surface),
        FileFormat("ball.obj", _text(OBJ), read_surface_points),
        FileFormat("ball.vtp", SPHERE.save, read_surface),
        FileFormat("case.vtu", _prediction, read_mesh),
        FileFormat("moved.vtu", _prediction, read_displacement),
        FileFormat("ascii.vtu", _grid, read_mesh),
        FileFormat("binary.vtk", _grid, read_vtk, isolated=True),
        FileFormat("ascii.vtk", _grid, read_vtk, isolated=True),
        FileFormat("surface.vtk", SPHERE.save, read_surface, isolated=True),
        FileFormat("ball.off", _meshio("off"), read_surface, isolated=True),
        FileFormat("ball.inp", _meshio("abaqus"), read_surface, isolated=True),
        FileFormat("v2.msh", _meshio("gmsh22"), read_surface, isolated=True),
        FileFormat("v4.msh", _meshio("gmsh"), read_surface, isolated=True),
        FileFormat("cells.msh", _tetrahedra("gmsh22"), read_tetrahedra, isolated=True),
        FileFormat("cells.inp", _tetrahedra("abaqus"), read_tetrahedra, isolated=True),
        FileFormat("arrays.npz", _arrays, _read_arrays, compressed=True),
        FileFormat("squeezed.npz", _squeezed, _read_arrays, compressed=True),
        FileFormat("case.feb", _febio, read_febio),
        FileFormat("u.log", _text(LOG), _read_log),
        FileFormat("pairs.csv", _csv, read_point_pairs),
        FileFormat("pairs.tag", _tag, read_point_pairs),
        FileFormat("points.fcsv", _fcsv, read_surface_points),
        FileFormat("pairs.mrk.json", _mrk, read_point_pairs),
        FileFormat("load.json", _load_case, lambda path: read_load_case(path, MESH)),
        FileFormat("loads.toml", _text(TOML), _read_toml),
    )
}


def arrays_in(value: Any) -> Iterator[np.ndarray[Any, Any]]:
    """Yield all arrays and numbers within what a reader returned, to compare."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, int | float | str | bool):
        yield np.asarray(value)
    elif isinstance(value, Mapping):
        for key in value:
            yield from arrays_in(value[key])
    elif isinstance(value, list | tuple):
        for item in value:
            yield from arrays_in(item)
    elif hasattr(value, "__dataclass_fields__"):
        for name in value.__dataclass_fields__:
            yield from arrays_in(getattr(value, name))


def same(one: Any, other: Any) -> bool:
    """Whether two results of a reader hold the same numbers."""
    ours, theirs = list(arrays_in(one)), list(arrays_in(other))
    return len(ours) == len(theirs) and all(
        np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
        for a, b in zip(ours, theirs, strict=True)
    )

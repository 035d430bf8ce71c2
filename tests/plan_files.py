"""Small plans of every format, which several tests read."""

import json
import warnings
from pathlib import Path

import nibabel as nib
import numpy as np
import pyvista as pv
from nibabel.streamlines import Field, TckFile, Tractogram, TrkFile

from physgnn.arrays import FloatArray

LPS = np.array([-1.0, -1.0, 1.0])
POINTS = np.array([[12.0, 14.5, 20.0], [20.25, 22.0, 18.0], [26.0, 12.0, 30.125]])
LABELS = ("entry", "target, deep", "Brocá")


def write_markups(path: Path, kind: str = "Curve", system: str = "LPS") -> None:
    """Write three points, and one that is not placed."""
    sign = LPS if system == "LPS" else np.ones(3)
    controls = [
        {
            "id": str(i + 1),
            "label": label,
            "description": "as planned",
            "position": (sign * point).tolist(),
            "orientation": [-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0],
            "selected": i != 1,
            "positionStatus": "defined",
        }
        for i, (label, point) in enumerate(zip(LABELS, POINTS, strict=True))
    ]
    controls.append({"id": "9", "label": "later", "positionStatus": "undefined"})
    markup = {
        "type": kind,
        "coordinateSystem": system,
        "coordinateUnits": "mm",
        "curveType": "cubicSpline",
        "numberOfPointsPerInterpolatingSegment": 10,
        "controlPoints": controls,
        "measurements": [
            {"name": "length", "enabled": True, "units": "mm", "value": 31.2},
            {"name": "score", "enabled": True, "value": 7},
        ],
        "display": {"color": [0.4, 1.0, 0.3], "opacity": 0.5},
    }
    path.write_text(
        json.dumps({"@schema": "markups-schema-v1.0.3.json#", "markups": [markup]}),
        "utf-8",
    )


def write_fcsv(path: Path, system: str = "LPS") -> None:
    """Write three points as 3D Slicer 4.11 did, with CRLF as on Windows."""
    sign = np.ones(3) if system in ("RAS", "0") else LPS
    head = (
        "# Markups fiducial file version = 4.11\r\n"
        f"# CoordinateSystem = {system}\r\n"
        "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\r\n"
    )
    rows = [
        f'node_{i},{x},{y},{z},0,0,0,1,1,1,0,"{label}",a note,\r\n'
        for i, ((x, y, z), label) in enumerate(zip(sign * POINTS, LABELS, strict=True))
    ]
    path.write_bytes((head + "".join(rows)).encode())


def write_tags(path: Path) -> None:
    """Write three tags of one volume."""
    rows = [
        f' {x} {y} {z} 1 2 3 "{label}"'
        for (x, y, z), label in zip(POINTS, LABELS, strict=True)
    ]
    text = "MNI Tag Point File\nVolumes = 1;\n% Points = none;\n\nPoints =\n"
    path.write_text(text + "\n".join(rows) + ";\n", "utf-8")


def write_table(path: Path) -> None:
    """Write three points with a label each."""
    rows = [
        f'"{label}",{x},{y},{z},7\n'
        for (x, y, z), label in zip(POINTS, LABELS, strict=True)
    ]
    path.write_text("label,x,y,z,score\n" + "".join(rows), "utf-8")


def ball() -> pv.PolyData:
    """A ball inside the test body, with colours, scalars and normals."""
    made = pv.Icosphere(radius=8.0, center=(20.0, 20.0, 20.0), nsub=2)
    made = made.compute_normals(cell_normals=False, split_vertices=False)
    made.points = np.asarray(made.points, np.float64)
    random = np.random.default_rng(0)
    made.point_data["colours"] = random.integers(0, 255, (made.n_points, 3), np.uint8)
    made.cell_data["thickness"] = random.normal(size=made.n_cells)
    return made


PLY_HEAD = (
    "ply\nformat {form} 1.0\ncomment made by é\nelement vertex {n}\n"
    "property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
    "property float nx\nproperty float ny\nproperty float nz\n"
    "element face {m}\nproperty list uchar int vertex_indices\nend_header\n"
)


def write_ply(path: Path, form: str = "binary_big_endian") -> None:
    """Write the ball with a colour and normals."""
    made = ball()
    head = PLY_HEAD.format(form=form, n=made.n_points, m=made.n_cells).encode()
    order = ">" if "big" in form else "<"
    row = [("x", "f4", 3), ("red", "u1"), ("n", "f4", 3)]
    table = np.zeros(made.n_points, np.dtype(row).newbyteorder(order))
    table["x"], table["n"] = made.points, made.point_data["Normals"]
    table["red"] = made.point_data["colours"][:, 0]
    face = np.dtype([("k", "u1"), ("i", "i4", 3)]).newbyteorder(order)
    faces = np.zeros(made.n_cells, face)
    faces["k"], faces["i"] = 3, made.regular_faces
    if form != "ascii":
        path.write_bytes(head + table.tobytes() + faces.tobytes())
        return
    lines = [
        " ".join(map(str, [*one["x"], one["red"], *one["n"]])) for one in table
    ] + ["3 " + " ".join(map(str, one)) for one in made.regular_faces]
    path.write_bytes(head + "\n".join(lines).encode() + b"\n")


def write_obj(path: Path) -> None:
    """Write the ball in LPS with colours, and a normal for each face."""
    made = ball()
    lines = ["# 3D Slicer output. SPACE=LPS", "mtllib plan.mtl", "g tumour"]
    lines += [f"v {x} {y} {z} 0.5 0.25 1" for x, y, z in made.points * LPS]
    lines += ["vn 0 0 1"] * made.n_cells
    faces = enumerate(made.regular_faces + 1)
    lines += [f"f {a}//{i + 1} {b}//{i + 1} {c}//{i + 1}" for i, (a, b, c) in faces]
    path.write_text("\n".join(lines) + "\n")


def write_stl(path: Path, *, binary: bool = True) -> None:
    """Write the ball as VTK does."""
    ball().save(path, binary=binary)


def write_vtp(path: Path) -> None:
    """Write the ball in LPS as 3D Slicer does: compressed and appended."""
    made = ball()
    made.points = made.points * LPS
    made.field_data["SPACE"] = ["LPS"]
    made.save(path)


TRACTS = [POINTS, POINTS[:2] + 3.0]
TRK_AFFINE = np.array(
    [[-2.0, 0, 0, 50], [0, 2.0, 0.1, -9], [0, 0, 2.5, -5], [0, 0, 0, 1]]
)


def tractogram() -> Tractogram:
    """Two tracts with a scalar at every point and a number of each."""
    return Tractogram(
        [one.astype(np.float32) for one in TRACTS],
        data_per_point={"fa": [np.full((len(one), 1), 0.25) for one in TRACTS]},
        data_per_streamline={"weight": np.array([[1.0], [2.0]])},
        affine_to_rasmm=np.eye(4),
    )


def write_trk(path: Path) -> None:
    """Write two tracts of an oblique scan."""
    header = {
        Field.VOXEL_TO_RASMM: TRK_AFFINE,
        Field.VOXEL_SIZES: np.array([2.0, 2.0, 2.5]),
        Field.DIMENSIONS: np.array([40, 50, 60]),
        Field.VOXEL_ORDER: "LAS",
    }
    TrkFile(tractogram(), header=header).save(str(path))


def write_tck(path: Path) -> None:
    """Write two tracts, with a line of MRtrix's header."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that scalars are not kept
        bare = Tractogram(tractogram().streamlines, affine_to_rasmm=np.eye(4))
        TckFile(bare, header={"step_size": "0.5"}).save(str(path))


def all_points(tracts: nib.streamlines.ArraySequence) -> FloatArray:
    """Return the points of all tracts, one after the other."""
    return np.concatenate([np.asarray(one, np.float64) for one in tracts])


WRITERS = {
    "plan.mrk.json": write_markups,
    "plan.fcsv": write_fcsv,
    "plan.tag": write_tags,
    "plan.csv": write_table,
    "binary.stl": write_stl,
    "ascii.stl": lambda path: write_stl(path, binary=False),
    "plan.vtp": write_vtp,
    "binary.ply": write_ply,
    "ascii.ply": lambda path: write_ply(path, "ascii"),
    "plan.obj": write_obj,
    "plan.trk": write_trk,
    "plan.tck": write_tck,
}
"""Name → writer, a row for every format and kind."""

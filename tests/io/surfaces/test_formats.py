import os
from pathlib import Path

import meshio
import numpy as np
import pytest
import pyvista as pv
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial import cKDTree

from physgnn.errors import InputError
from physgnn.geometry import check_surface, volume
from physgnn.io import SURFACE_READERS, read_surface

FORMATS = [
    (".stl", True), (".stl", False), (".ply", True), (".ply", False),
    (".obj", True), (".vtp", True), (".vtp", False), (".vtk", True), (".vtk", False),
    (".msh", True), (".msh", False), (".inp", False), (".off", False), (".STL", True),
]  # fmt: skip


def save(path: Path, binary: bool = True) -> pv.PolyData:
    body = pv.Icosphere(radius=30.0, center=(10.0, -20.0, 5.0), nsub=2)
    if path.suffix == ".obj":
        body.save(path)
    elif path.suffix in (".msh", ".inp", ".off"):
        faces = [("triangle", body.regular_faces)]
        made = meshio.Mesh(np.asarray(body.points, np.float64), faces)
        form = {".msh": "gmsh", ".inp": "abaqus", ".off": "off"}[path.suffix]
        kind = {"binary": binary} if form == "gmsh" else {}
        meshio.write(path, made, file_format=form, **kind)
    else:
        body.save(path, binary=binary)
    return body


@pytest.mark.parametrize(("suffix", "binary"), FORMATS)
def test_every_format_gives_the_same_surface(
    tmp_path: Path, suffix: str, binary: bool
) -> None:
    body = save(tmp_path / f"a{suffix}", binary)
    before = (tmp_path / f"a{suffix}").read_bytes()
    surface = read_surface(tmp_path / f"a{suffix}")
    assert (surface.n_points, surface.n_faces) == (162, 320)
    distance, _ = cKDTree(surface.points).query(body.points)
    assert distance.max() < 1e-4
    assert volume(surface) == pytest.approx(body.volume, rel=1e-5)
    assert check_surface(surface, "brain")[1] == []
    assert (tmp_path / f"a{suffix}").read_bytes() == before


def test_vtp_keeps_double_precision(tmp_path: Path) -> None:
    body = pv.Icosphere(nsub=1)
    body.points = np.asarray(body.points, dtype=np.float64) + np.pi
    body.save(tmp_path / "a.vtp")
    points = read_surface(tmp_path / "a.vtp").points
    np.testing.assert_array_equal(points, np.unique(body.points, axis=0))


@given(arrays(np.float64, (4, 3), elements=st.floats(-1e3, 1e3), unique=True))
def test_ascii_stl_keeps_every_digit(tmp_path_factory, points: np.ndarray) -> None:  # type: ignore[no-untyped-def]
    lines = ["solid made by hand"]
    for face in ([0, 1, 2], [0, 2, 3]):
        corners = [f"vertex {x!r} {y!r} {z!r}" for x, y, z in points[face].tolist()]
        lines += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
    path = tmp_path_factory.mktemp("stl") / "a.stl"
    path.write_text("\r\n".join([*lines, "endsolid"]))
    surface = read_surface(path)
    np.testing.assert_array_equal(
        surface.points[surface.faces], points[[[0, 1, 2], [0, 2, 3]]]
    )


def test_binary_stl_may_begin_with_solid(tmp_path: Path) -> None:
    save(tmp_path / "a.stl")
    data = (tmp_path / "a.stl").read_bytes()
    (tmp_path / "a.stl").write_bytes(b"solid".ljust(80) + data[80:])
    assert read_surface(tmp_path / "a.stl").n_points == 162


def test_suffix_in_capitals_and_polygons(tmp_path: Path) -> None:
    cube = "".join(f"v {x} {y} {z}\n" for x in (0, 9) for y in (0, 9) for z in (0, 9))
    quads = "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
    (tmp_path / "a.OBJ").write_text(cube + quads)
    surface = read_surface(tmp_path / "a.OBJ")
    assert (surface.n_points, surface.n_faces) == (8, 12)
    assert abs(volume(surface)) == pytest.approx(9.0**3)


@pytest.mark.parametrize("suffix", SURFACE_READERS)
@pytest.mark.parametrize("content", ["empty", "text", "noise", "another", "cut off"])
def test_a_file_that_is_not_what_its_name_says(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], suffix: str, content: str
) -> None:
    path, other = tmp_path / f"a{suffix}", tmp_path / "b.vtp"
    save(path)
    save(tmp_path / ("b.ply" if suffix == ".vtp" else other.name))
    (another,) = tmp_path.glob("b.*")
    data = path.read_bytes()
    path.write_bytes(
        {
            "empty": b"",
            "text": b"hello, this is no surface\n",
            "noise": np.random.default_rng(0).bytes(5000),
            "another": another.read_bytes(),
            "cut off": data[: len(data) // 3],
        }[content]
    )
    with pytest.raises(InputError) as caught:
        read_surface(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("name", "message"),
    [("a.nrrd", ".stl, .ply, .obj, .vtp"), ("a", "got ''"), ("a.stl", "no such file")],
)
def test_unknown_and_missing_files(tmp_path: Path, name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_surface(tmp_path / name)


def test_a_folder_is_no_surface(tmp_path: Path) -> None:
    os.mkdir(tmp_path / "a.stl")  # noqa: PTH102
    with pytest.raises(InputError, match="no such file"):
        read_surface(tmp_path / "a.stl")


@pytest.mark.parametrize("value", ["nan", "inf", "x"])
def test_vertices_that_are_no_numbers(tmp_path: Path, value: str) -> None:
    corners = f"vertex 0 0 {value}\nvertex 1 0 0\nvertex 0 1 0\n"
    (tmp_path / "a.stl").write_text(
        f"solid\nfacet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\nendsolid\n"
    )
    with pytest.raises(InputError, match=r"a\.stl: .*(finite|three numbers)"):
        read_surface(tmp_path / "a.stl")


def test_a_surface_without_faces(tmp_path: Path) -> None:
    pv.PolyData(np.zeros((3, 3))).save(tmp_path / "a.vtp")
    pv.PolyData().save(tmp_path / "b.vtp")
    (tmp_path / "c.stl").write_text("solid nothing\nendsolid nothing\n")
    for name in ("a.vtp", "b.vtp", "c.stl"):
        with pytest.raises(InputError):
            read_surface(tmp_path / name)

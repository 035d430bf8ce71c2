from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

from physgnn.errors import InputError
from physgnn.geometry import volume
from physgnn.io import read_surface

# A tetrahedron as other programs write it: comments, colours, another element, and
# doubles.
HEADER = """ply
format {} 1.0
comment made by hand
element vertex 4
property double x
property double y
property double z
property uchar red
element face 4
property list uchar int vertex_indices
element edge 1
property int vertex1
property int vertex2
end_header
"""
POINTS = np.array([[0.1, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])


def binary(order: str) -> bytes:
    vertex = np.dtype([("p", f"{order}f8", 3), ("c", "u1")])
    face = np.dtype([("n", "u1"), ("i", f"{order}i4", 3)])
    vertices, faces = np.zeros(4, vertex), np.zeros(4, face)
    vertices["p"], faces["n"], faces["i"] = POINTS, 3, FACES
    kind = "little" if order == "<" else "big"
    header = HEADER.format(f"binary_{kind}_endian").encode()
    edge = np.array([0, 1], f"{order}i4")
    return header + vertices.tobytes() + faces.tobytes() + edge.tobytes()


def ascii_text() -> bytes:
    lines = [f"{x!r} {y!r} {z!r} 255" for x, y, z in POINTS.tolist()]
    lines += ["3 " + " ".join(map(str, face)) for face in FACES.tolist()]
    return (HEADER.format("ascii") + "\n".join([*lines, "0 1"])).encode()


CONTENTS = {"little": binary("<"), "big": binary(">"), "ascii": ascii_text()}


@pytest.mark.parametrize("kind", CONTENTS)
def test_extra_columns_and_elements_are_passed_over(tmp_path: Path, kind: str) -> None:
    (tmp_path / "a.ply").write_bytes(CONTENTS[kind])
    surface = read_surface(tmp_path / "a.ply")
    np.testing.assert_array_equal(surface.points, np.unique(POINTS, axis=0))
    assert volume(surface) == pytest.approx(0.9 / 6)


@pytest.mark.parametrize("kind", CONTENTS)
def test_cut_off_anywhere_is_an_error_of_ours(tmp_path: Path, kind: str) -> None:
    whole = CONTENTS[kind]
    for size in range(0, len(whole) - 12, 3):
        (tmp_path / "a.ply").write_bytes(whole[:size])
        with pytest.raises(InputError, match=r"a\.ply: "):
            read_surface(tmp_path / "a.ply")


def test_polygons_become_triangles(tmp_path: Path) -> None:
    cube = pv.Cube(x_length=2.0, y_length=2.0, z_length=2.0)
    cube.save(tmp_path / "a.ply")
    surface = read_surface(tmp_path / "a.ply")
    assert (surface.n_points, surface.n_faces) == (8, 12)
    assert volume(surface) == pytest.approx(8.0)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"property double x", b"property quad x"),
        (b"property double x", b"property double u"),
        (b"vertex_indices", b"corners"),
        (b"binary_little_endian", b"binary_middle_endian"),
        (b"element face 4", b"element face -4"),
        (b"element face 4", b"element face many"),
        (b"element vertex 4", b"element vertex 400000000"),
    ],
)
def test_damaged_headers(tmp_path: Path, old: bytes, new: bytes) -> None:
    (tmp_path / "a.ply").write_bytes(CONTENTS["little"].replace(old, new))
    with pytest.raises(InputError, match=r"a\.ply: "):
        read_surface(tmp_path / "a.ply")


def test_an_index_beyond_the_points(tmp_path: Path) -> None:
    content = CONTENTS["ascii"].replace(b"3 1 2 3", b"3 1 2 9")
    (tmp_path / "a.ply").write_bytes(content)
    with pytest.raises(InputError, match="must index 0…3"):
        read_surface(tmp_path / "a.ply")

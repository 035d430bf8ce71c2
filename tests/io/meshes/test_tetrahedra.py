"""Tetrahedral meshes of other programs: every format gives the same cells and names."""

from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest
import pyvista as pv

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import signed_volumes
from physgnn.io.meshes.tetrahedra import Tetrahedra, read_tetrahedra

MESH = block_mesh(2, side=80.0)
GROUP = np.where(np.arange(MESH.n_cells) < 5, 7, 3)
FACE = [("triangle", MESH.cells[:2, :3])]


def gmsh2(binary: bool) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        made = meshio.Mesh(
            MESH.points,
            [*FACE, ("tetra", MESH.cells)],
            cell_data={
                name: [np.array([9, 9]), GROUP]
                for name in ("gmsh:physical", "gmsh:geometrical")
            },
            field_data={"skin": np.array([9, 2]), "Tumor": np.array([7, 3])},
        )
        meshio.write(path, made, file_format="gmsh22", binary=binary)

    return write


def gmsh4(path: Path) -> None:
    """Write as Gmsh 4.1 does: two volumes, and groups that have them."""
    n, m = MESH.n_points, MESH.n_cells
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", "2"]
    lines += ['3 3 "brain"', '3 7 "Tumor"', "$EndPhysicalNames", "$Entities", "0 0 0 2"]
    lines += ["1 0 0 0 80 80 80 1 3 0", "2 0 0 0 80 80 80 1 7 0", "$EndEntities"]
    lines += ["$Nodes", f"1 {n} 1 {n}", f"3 1 0 {n}", *map(str, range(1, n + 1))]
    lines += [" ".join(map(repr, row)) for row in MESH.points.tolist()]
    lines += ["$EndNodes", "$Elements", f"2 {m} 1 {m}"]
    for volume, first, end in ((2, 0, 5), (1, 5, m)):
        lines.append(f"3 {volume} 4 {end - first}")
        lines += [
            f"{i + 1} " + " ".join(map(str, MESH.cells[i] + 1))
            for i in range(first, end)
        ]
    path.write_text("\n".join([*lines, "$EndElements", ""]))


def gmsh4_binary(path: Path) -> None:
    """Cells alone: meshio writes no groups of this version."""
    made = meshio.Mesh(MESH.points, [("tetra", MESH.cells)])
    meshio.write(path, made, file_format="gmsh", binary=True)


def abaqus(path: Path) -> None:
    lines = ["*HEADING", "*NODE"]
    lines += [
        f"{i + 1}, {x!r}, {y!r}, {z!r}"
        for i, (x, y, z) in enumerate(MESH.points.tolist())
    ]
    lines.append("*ELEMENT, TYPE=C3D4, ELSET=ALL")
    lines += [
        f"{i + 1}, " + ", ".join(map(str, c + 1)) for i, c in enumerate(MESH.cells)
    ]
    lines += ["*ELSET, ELSET=tumour", "1, 2, 3, 4, 5", "*NSET, NSET=fixed", "1, 2, 3"]
    path.write_text("\n".join(lines) + "\n")


def vtk(path: Path) -> None:
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: MESH.cells}, MESH.points)
    grid.cell_data["MaterialIds"] = GROUP
    grid.save(path)


WRITERS = {
    "v2.msh": gmsh2(False),
    "v2b.msh": gmsh2(True),
    "v4.msh": gmsh4,
    "a.inp": abaqus,
    "a.vtk": vtk,
    "a.vtu": vtk,
}


def same(found: Tetrahedra) -> None:
    np.testing.assert_allclose(found.points, MESH.points, atol=1e-12)
    np.testing.assert_array_equal(found.cells, MESH.cells)
    first = found.numbers == found.numbers[0]
    np.testing.assert_array_equal(first, np.arange(MESH.n_cells) < 5)


@pytest.mark.parametrize("name", WRITERS)
def test_every_format(name: str, tmp_path: Path) -> None:
    WRITERS[name](tmp_path / name)
    found = read_tetrahedra(tmp_path / name)
    same(found)
    if name.startswith("v"):
        assert found.names[7] == "Tumor"
    if name == "a.inp":
        assert found.names[int(found.numbers[0])] == "tumour"
        np.testing.assert_array_equal(found.point_sets["fixed"], [0, 1, 2])


def test_gmsh_4_binary(tmp_path: Path) -> None:
    gmsh4_binary(tmp_path / "a.msh")
    found = read_tetrahedra(tmp_path / "a.msh")
    np.testing.assert_array_equal(found.cells, MESH.cells)
    assert len(np.unique(found.numbers)) == 1


def test_what_is_repaired_is_said(tmp_path: Path) -> None:
    lines: list[str] = []
    cells = MESH.cells.copy()
    cells[[3, 4], :2] = cells[[3, 4], 1::-1]
    made = meshio.Mesh(MESH.points, [*FACE, ("tetra", cells)])
    meshio.write(tmp_path / "a.msh", made, file_format="gmsh22")
    found = read_tetrahedra(tmp_path / "a.msh", log=lines.append)
    assert (signed_volumes(found.points, found.cells) > 0).all()
    assert lines == [
        "2 faces, edges and points beside the cells: not used",
        "2 cells were inside out: turned",
    ]


def test_points_at_the_middles_of_edges(tmp_path: Path) -> None:
    lines: list[str] = []
    edges = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
    middles = np.stack([MESH.points[MESH.cells[:, e]].mean(axis=1) for e in edges], 1)
    index = MESH.n_points + np.arange(6 * MESH.n_cells).reshape(-1, 6)
    points = np.concatenate([MESH.points, middles.reshape(-1, 3)])
    made = meshio.Mesh(points, [("tetra10", np.hstack([MESH.cells, index]))])
    meshio.write(tmp_path / "a.msh", made, file_format="gmsh22")
    found = read_tetrahedra(tmp_path / "a.msh", log=lines.append)
    np.testing.assert_array_equal(found.cells, MESH.cells)
    assert "middles of edges" in lines[0]


def test_other_cells_are_refused(tmp_path: Path) -> None:
    for kind, n, message in (
        ("hexahedron", 8, "hexahedra"),
        ("triangle", 3, "must have tetrahedra"),
    ):
        made = meshio.Mesh(MESH.points, [(kind, np.arange(n)[None])])
        meshio.write(tmp_path / "a.msh", made, file_format="gmsh22")
        with pytest.raises(InputError, match=message):
            read_tetrahedra(tmp_path / "a.msh")
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: MESH.cells}, MESH.points)
    grid.cell_data["one"] = grid.cell_data["two"] = GROUP
    grid.save(tmp_path / "b.vtu")
    with pytest.raises(
        InputError, match=r"one cell array .*one, two.*call it 'region'"
    ):
        read_tetrahedra(tmp_path / "b.vtu")
    pv.ImageData(dimensions=(4, 4, 4)).save(tmp_path / "c.vtk")
    with pytest.raises(InputError, match="neither polygons nor a grid of cells"):
        read_tetrahedra(tmp_path / "c.vtk")
    with pytest.raises(InputError, match="no such file"):
        read_tetrahedra(tmp_path / "absent.msh")

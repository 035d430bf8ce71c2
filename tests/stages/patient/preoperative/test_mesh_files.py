"""`physgnn mesh` on tetrahedral meshes and segmentations with names."""

import re
from pathlib import Path

import meshio
import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry import TetMesh
from physgnn.io import read_mesh
from physgnn.stages import mesh

BLOCK = block_mesh(3, side=110.0)
INNER = np.linalg.norm(BLOCK.points[BLOCK.cells].mean(axis=1) - 60.0, axis=1) < 30.0


def written(
    path: Path, *, scale: float = 1.0, names: dict[str, int] | None = None
) -> Path:
    groups = np.where(INNER, 7, 3)
    points = np.concatenate([BLOCK.points, [[5.0, 5.0, 300.0]]]) * scale
    made = meshio.Mesh(
        points,
        [("tetra", BLOCK.cells)],
        cell_data={"gmsh:physical": [groups], "gmsh:geometrical": [groups]},
        field_data={n: np.array([k, 3]) for n, k in (names or {}).items()},
    )
    meshio.write(path, made, file_format="gmsh22")
    return path


def taken(path: Path, out: Path, **options: object) -> tuple[TetMesh, list[str]]:
    lines: list[str] = []
    mesh(out, segmentation=path, log=lines.append, **options)  # type: ignore[arg-type]
    return read_mesh(out), lines


def test_groups_become_regions_by_their_names(tmp_path: Path) -> None:
    path = written(tmp_path / "a.msh", names={"brain": 3, "Tumor": 7})
    made, lines = taken(path, tmp_path / "case.vtu")
    np.testing.assert_array_equal(made.region, INNER.astype(int))
    np.testing.assert_allclose(made.points, BLOCK.points)
    said = "\n".join(lines)
    assert re.search(r"region 7 'Tumor' → tumour: \d+ cells, [\d.]+ ml", said)
    assert "points of no cell: 1, dropped" in said


def test_groups_without_names_must_be_named(tmp_path: Path) -> None:
    path, out = written(tmp_path / "a.msh"), tmp_path / "case.vtu"
    with pytest.raises(InputError, match=r"a\.msh: .*it has 3, 7.*--labels brain=N"):
        mesh(out, segmentation=path)
    made, _ = taken(path, out, labels="brain=3,tumour=7")
    np.testing.assert_array_equal(made.region, INNER.astype(int))
    with pytest.raises(InputError, match=r"not used: 7"):
        mesh(out, segmentation=path, labels="brain=3")
    made, _ = taken(path, out, labels="brain=3", ignore_labels=True)
    assert made.n_cells == int((~INNER).sum())


def test_units_volume_and_options_are_checked(tmp_path: Path) -> None:
    names, out = {"brain": 3, "tumour": 7}, tmp_path / "case.vtu"
    path = written(tmp_path / "m.msh", scale=1e-3, names=names)
    with pytest.raises(InputError, match="metres"):
        mesh(out, segmentation=path)
    path = written(tmp_path / "cm.msh", scale=0.1, names=names)
    with pytest.raises(InputError, match="centimetres"):
        mesh(out, segmentation=path)
    path = written(tmp_path / "mm.msh", names=names)
    with pytest.raises(InputError, match="a mesh keeps its cells"):
        mesh(out, segmentation=path, target_points=100)
    assert not out.exists()


def test_a_mesh_of_ours_passes_through(tmp_path: Path) -> None:
    from physgnn.io import write_mesh

    ours = TetMesh(BLOCK.points, BLOCK.cells, INNER.astype(np.int32), BLOCK.point_sets)
    write_mesh(tmp_path / "ours.vtu", ours)
    made, _ = taken(tmp_path / "ours.vtu", tmp_path / "case.vtu")
    assert made.content_hash == ours.content_hash
    assert made.point_sets.keys() == ours.point_sets.keys()
    for name, ids in ours.point_sets.items():
        np.testing.assert_array_equal(made.point_set(name), ids)

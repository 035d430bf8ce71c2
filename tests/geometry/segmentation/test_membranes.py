"""Falx and tentorium of label maps whose sheets are known."""

import numpy as np
import pytest

from physgnn.arrays import IntArray
from physgnn.geometry.image import LabelVolume
from physgnn.geometry.segmentation.labels.label_tables import LABEL_TABLES
from physgnn.geometry.segmentation.membranes import membrane_sets, sheet_points
from physgnn.geometry.tetmesh import TetMesh

TABLE = LABEL_TABLES["freesurfer"]
GAP_MM = 2.0


@pytest.fixture
def labels() -> LabelVolume:
    """Two halves of cortex 4 mm apart above z = 2, white matter below 0 joins them.

    The cerebellum lies below z = −12, 4 mm under the cortex.
    """
    x, _, z = np.indices((40, 40, 40)) - 19.5
    data = np.zeros((40, 40, 40), dtype=np.int32)
    data[(x < -GAP_MM) & (z > -8)] = 3
    data[(x > GAP_MM) & (z > -8)] = 42
    data[z < -12] = 8
    affine = np.eye(4)
    affine[:3, 3] = -19.5
    return LabelVolume(data, affine)


def body() -> TetMesh:
    from meshes import block_mesh

    cube = block_mesh(10, side=40.0)
    return TetMesh(cube.points - 20.0, cube.cells, np.zeros_like(cube.region))


def lies_at(mesh: TetMesh, points: IntArray, axis: int, place: float) -> bool:
    return bool((np.abs(mesh.points[points, axis] - place) <= 4.0).all())


def test_the_sheets_lie_midway(labels: LabelVolume) -> None:
    falx = sheet_points(labels, TABLE.left, TABLE.right)
    assert np.abs(falx[:, 0]).max() <= 0.5
    assert falx[:, 2].min() > -12
    tentorium = sheet_points(labels, (*TABLE.left, *TABLE.right), TABLE.cerebellum)
    assert np.abs(tentorium[:, 2] + 10.0).max() <= 1.5


def test_one_layer_of_points_becomes_a_set(labels: LabelVolume) -> None:
    mesh = body()
    sets = membrane_sets(mesh, labels, TABLE)
    assert list(sets) == ["falx", "tentorium"]
    assert lies_at(mesh, sets["falx"], 0, 0.0)
    assert lies_at(mesh, sets["tentorium"], 2, -10.0)
    # eleven by eleven points a layer of the cube; the falx ends above the cerebellum
    assert 60 <= len(sets["falx"]) <= 121
    assert 80 <= len(sets["tentorium"]) <= 2 * 121


def test_a_map_without_sides_has_no_membranes(labels: LabelVolume) -> None:
    assert membrane_sets(body(), labels, LABEL_TABLES["mask"]) == {}
    half = LabelVolume(np.where(labels.data == 42, 0, labels.data), labels.affine)
    assert "falx" not in membrane_sets(body(), half, TABLE)
    assert list(membrane_sets(body(), labels, LABEL_TABLES["harvard-oxford"])) == []

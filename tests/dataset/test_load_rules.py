"""Loads told in words land where they should on a mesh."""

from pathlib import Path

import numpy as np
import pytest

from physgnn.dataset.load_rules import (
    MeasuredPlaces,
    PressureOn,
    Shift,
    with_more,
    without_forces,
)
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import Gravity, LoadPath
from physgnn.mechanics.loads.growth_rules import GrowthIn

DOWN = Gravity((0, 0, -2))


def measured(folder: Path, rows: np.ndarray) -> MeasuredPlaces:
    file = folder / "measured.csv"
    np.savetxt(file, rows, delimiter=",")
    return MeasuredPlaces(str(file), snap_mm=1.0)


def test_pressure_pushes_the_faces_of_a_set(block: TetMesh) -> None:
    load = PressureOn("loaded", 50.0).on(block)
    assert np.isin(load.faces, block.point_set("loaded")).all()
    force = load.bind(block)(np.zeros_like(block.points), 1.0).sum(axis=0)
    np.testing.assert_allclose(force, [0, 0, -50e-6 * 100], atol=1e-15)  # 10 × 10 mm
    with pytest.raises(InputError, match="no point set 'patch'"):
        PressureOn("patch", 50.0).on(block)


def test_a_set_shifts_as_one(block: TetMesh) -> None:
    load = Shift("loaded", (0.0, 0.0, -1.5)).on(block)
    assert np.array_equal(load.nodes, block.point_set("loaded"))
    assert (load.displacement == [0.0, 0.0, -1.5]).all()


def test_measured_points_move_the_nearest(block: TetMesh, tmp_path: Path) -> None:
    """Two points share a nearest one and count by their mean; offsets don't matter."""
    a, b = block.points[block.point_set("loaded")[[0, 9]]]
    ends = np.array([a + 0.2, a - 0.2, b])
    moves = np.array([[0, 0, -1.0], [0, 0.4, -2.0], [0.3, 0, 0]])
    load = measured(tmp_path, np.hstack([ends, ends + moves])).on(block)
    assert load.nodes.tolist() == block.point_set("loaded")[[0, 9]].tolist()
    expected = [[0, 0.2, -1.5], [0.3, 0, 0]]
    np.testing.assert_allclose(load.displacement, expected, atol=1e-12)


def test_a_measured_point_far_from_the_surface(block: TetMesh, tmp_path: Path) -> None:
    rows = np.full((3, 6), 0.0)
    rows[1, :3] = 30.0
    with pytest.raises(InputError, match=r"\[30.0, 30.0, 30.0\] must lie within 1 mm"):
        measured(tmp_path, rows).on(block)


def test_with_forces_and_without(block: TetMesh) -> None:
    top = block.point_set("loaded")
    pushed = LoadPath(top[:1], np.ones((1, 3)), np.ones(1))
    paths = with_more(block, top, paths=lambda *_: [pushed, pushed], more=[DOWN])
    assert [path.more for path in paths] == [(DOWN,), (DOWN,)]
    assert all(np.array_equal(path.forces, pushed.forces) for path in paths)
    [alone] = without_forces(
        block, top, n_levels=4, more=[DOWN, Shift("loaded", (1, 0, 0))]
    )
    assert len(alone.nodes) == 0
    assert alone.load_factors.tolist() == [0.25, 0.5, 0.75, 1.0]
    assert len(alone.more) == 2


def test_growth_of_a_region_of_a_set_and_near_a_region(block: TetMesh) -> None:
    upper = GrowthIn(1.1, region="tumour").on(block)
    assert np.array_equal(upper.cells, np.flatnonzero(block.region == 1))
    assert (upper.volume_ratio == 1.1).all()
    low = block.points[:, 2] < 4
    inside = GrowthIn(0.95, points="low").on(
        block.with_point_sets(low=np.flatnonzero(low))
    )
    assert np.array_equal(inside.cells, np.flatnonzero(low[block.cells].all(axis=1)))
    tumour = block.points[np.unique(block.cells[block.region == 1])]
    centres = block.points[block.cells].mean(axis=1)
    away = np.linalg.norm(centres[:, None] - tumour, axis=2).min(axis=1)
    brain = block.region == 0
    half = float(np.median(away[brain]))
    near = GrowthIn(1.05, region="brain", near="tumour", within_mm=half).on(block)
    assert np.array_equal(near.cells, np.flatnonzero(brain & (away < half)))
    with pytest.raises(InputError, match=r"no region 'ventricle'.*brain, tumour"):
        GrowthIn(1.1, region="ventricle").on(block)
    with pytest.raises(InputError, match="no cell"):
        GrowthIn(1.1, region="brain", near="tumour", within_mm=0.01).on(block)
    with pytest.raises(InputError, match="region, points or near"):
        GrowthIn(1.1)
    with pytest.raises(InputError, match=r"0\.5…2"):
        GrowthIn(3.0, region="tumour")

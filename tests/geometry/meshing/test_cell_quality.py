import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.errors import InputError
from physgnn.geometry import TetMesh, check_quality, quality
from physgnn.geometry.meshing.cell_quality import (
    dihedral_angles,
    mean_ratio,
    radius_edge_ratio,
)

REGULAR = np.array([[1, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1]], dtype=float)


def one_cell(points: np.ndarray) -> TetMesh:
    a, b, c, d = points
    positive = np.dot(b - a, np.cross(c - a, d - a)) > 0
    cell = [0, 1, 2, 3] if positive else [0, 2, 1, 3]
    return TetMesh(points, np.array([cell]), np.array([0]))


def test_regular_tetrahedron() -> None:
    mesh = one_cell(REGULAR)
    assert mean_ratio(mesh) == pytest.approx([1.0])
    np.testing.assert_allclose(dihedral_angles(mesh), np.degrees(np.arccos(1 / 3)))
    assert radius_edge_ratio(mesh) == pytest.approx([np.sqrt(6) / 4])


def test_corner_of_a_cube() -> None:
    mesh = one_cell(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]))
    angles = np.sort(dihedral_angles(mesh)[0])
    np.testing.assert_allclose(angles[3:], 90.0)
    np.testing.assert_allclose(angles[:3], np.degrees(np.arccos(1 / np.sqrt(3))))
    assert radius_edge_ratio(mesh) == pytest.approx([np.sqrt(3) / 2])


@given(st.integers(0, 10_000), st.floats(0.01, 100.0))
def test_measures_do_not_depend_on_size_and_place(seed: int, scale: float) -> None:
    points = np.random.default_rng(seed).normal(size=(4, 3))
    if abs(np.linalg.det(points[1:] - points[0])) < 1e-3:
        return
    one, other = one_cell(points), one_cell(scale * points + 7.0)
    for measure in (mean_ratio, dihedral_angles, radius_edge_ratio):
        np.testing.assert_allclose(measure(one), measure(other), rtol=1e-5)
    assert 0.0 < mean_ratio(one)[0] <= 1.0


@given(st.integers(0, 10_000), st.floats(1e-3, 1.0))
def test_the_mean_ratio_is_that_of_liu_and_joe(seed: int, height: float) -> None:
    points = np.random.default_rng(seed).normal(size=(4, 3)) * [1.0, 1.0, height]
    spokes = points[1:] - points[0]
    volume = abs(np.linalg.det(spokes)) / 6.0
    if volume < 1e-6:
        return
    others = points[[1, 2, 3]] - points[[2, 3, 1]]
    squares = np.sum(spokes**2) + np.sum(others**2)
    expected = 12.0 * np.cbrt(3.0 * volume) ** 2 / squares
    assert mean_ratio(one_cell(points)) == pytest.approx([expected], rel=1e-8)


def test_flattening_lowers_the_mean_ratio_to_zero() -> None:
    heights = np.array([1.0, 0.3, 0.1, 0.01])
    ratios = [mean_ratio(one_cell(REGULAR * [1, 1, h]))[0] for h in heights]
    assert (np.diff(ratios) < 0).all()
    assert ratios[-1] < 0.1


def test_a_flat_cell_is_refused_with_its_place(block: TetMesh) -> None:
    points = block.points.copy()
    worst = int(mean_ratio(block).argmin())
    a, b, c, d = block.cells[worst]
    base = points[[a, b, c]].mean(axis=0)
    points[d] = base + 1e-3 * (points[d] - base)
    # turn the other cells at this point away: only this one is judged
    flat = one_cell(points[[a, b, c, d]])
    with pytest.raises(InputError, match=r"1 of 1 cells .* cell 0, near \(.*remesh"):
        check_quality(flat)
    assert check_quality(flat, floor=0.0).worst_cell == 0


def test_summary_is_one_line(block: TetMesh) -> None:
    found = check_quality(block, 0.0)
    assert found == quality(block)
    assert found.mean_ratio_min == mean_ratio(block).min()
    assert found.dihedral_min_deg == dihedral_angles(block).min()
    assert str(found).startswith("quality: mean ratio")
    assert "\n" not in str(found)


@pytest.mark.parametrize("floor", [-0.1, 1.0])
def test_refuses_a_floor_out_of_range(block: TetMesh, floor: float) -> None:
    with pytest.raises(InputError, match="floor"):
        check_quality(block, floor)

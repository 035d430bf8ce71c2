from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from physgnn.errors import InputError
from physgnn.geometry import (
    Complement,
    HalfSpace,
    Nearest,
    Sphere,
    TetMesh,
    Union,
    boundary_points,
    select,
)

TOP = HalfSpace((0, 0), (0, 0, 0), ">=", 10.0)
BOTTOM = HalfSpace((0, 0), (0, 0, 0), "<=", 0.0)


@given(a=st.floats(-180, 180), b=st.floats(-180, 180), p=st.floats(-200, 200))
def test_height_is_the_third_component_of_the_rotated_point(
    a: float, b: float, p: float
) -> None:
    points = np.random.default_rng(0).normal(size=(5, 3)) * 100
    turn = Rotation.from_euler("x", a, degrees=True) * Rotation.from_euler(
        "y", b, degrees=True
    )
    expected = turn.apply(points)[:, 2] + p
    rule = HalfSpace((a, b), (1.0, 2.0, p), "<", 0.0)
    np.testing.assert_allclose(rule.height(points), expected, atol=1e-9)


def test_half_space_takes_whole_faces_only(block: TetMesh) -> None:
    np.testing.assert_array_equal(select(block, TOP), block.point_set("loaded"))
    # points between the first two layers satisfy it, but no face does all round
    above = HalfSpace((0, 0), (0, 0, 0), ">", 0.0)
    assert set(select(block, above)) == set(
        np.intersect1d(np.flatnonzero(block.points[:, 2] > 0), boundary_points(block))
    )
    a_corner = HalfSpace((45, 45), (0, 0, 0), ">", 14.0)
    with pytest.raises(InputError, match="no point of the surface"):
        select(block, a_corner)


def test_sphere(block: TetMesh) -> None:
    chosen = select(block, Sphere((5, 5, 10), 4.0))
    distance = np.linalg.norm(block.points[chosen] - [5, 5, 10], axis=1)
    assert (distance <= 4.0).all()
    assert len(chosen) == 4


@given(count=st.integers(1, 56))
def test_nearest_gives_exactly_the_nearest_surface_points(
    block: TetMesh, count: int
) -> None:
    surface = boundary_points(block)
    chosen = select(block, Nearest((1.0, 2.0, 3.0), count))
    assert len(chosen) == count
    assert np.isin(chosen, surface).all()
    distance = np.linalg.norm(block.points - [1.0, 2.0, 3.0], axis=1)
    rest = np.setdiff1d(surface, chosen)
    assert len(rest) == 0 or distance[chosen].max() <= distance[rest].min() + 1e-12


def test_nearest_cannot_give_more_than_there_are(block: TetMesh) -> None:
    with pytest.raises(InputError, match="count = 57 exceeds the surface's 56 points"):
        select(block, Nearest((0, 0, 0), 57))


def test_union_and_complement_are_those_of_sets(block: TetMesh) -> None:
    top, bottom = set(select(block, TOP)), set(select(block, BOTTOM))
    assert set(select(block, Union((TOP, BOTTOM)))) == top | bottom
    surface = set(boundary_points(block).tolist())
    assert set(select(block, Complement(TOP))) == surface - top
    np.testing.assert_array_equal(
        select(block, Complement(Complement(TOP))), sorted(top)
    )


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Sphere((0, 0, 0), 0), "radius_mm must be > 0"),
        (lambda: Sphere((0, 0, 0), "big"), "radius_mm must be a number"),
        (lambda: Sphere((0, 0, 0), float("nan")), "finite"),
        (lambda: Sphere((0, 0), 1), "centre_mm must be 3 finite numbers"),
        (lambda: Sphere((0, 0, "x"), 1), "centre_mm must be 3 finite numbers"),
        (lambda: Sphere((0, 0, float("inf")), 1), "3 finite numbers"),
        (lambda: HalfSpace((0, 0), (0, 0, 0), "==", 0), "keep must be one of <, <=, >"),
        (lambda: HalfSpace((0, 0, 0), (0, 0, 0), "<", 0), "rotation_deg must be 2"),
        (lambda: Nearest((0, 0, 0), 0), "count must be"),
        (lambda: Nearest((0, 0, 0), 2.5), "count must be"),
        (lambda: Union([]), "one rule or more"),
    ],
)
def test_wrong_rules_are_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize(
    ("rule", "count"),
    [
        (HalfSpace((20, 0), (80, 90, 120), "<", 265.0), 502),
        (HalfSpace((15, 20), (80, 110, 130), ">", 275.5), 11),
        (HalfSpace((200, 0), (80, 110, 130), "<=", -32.4), 100),
    ],
    ids=["fixed", "loaded 1", "loaded 2"],
)
def test_published_counts(shared: Path, rule: HalfSpace, count: int) -> None:
    from physgnn.io import read_surface

    assert len(select(read_surface(shared / "paper" / "brain.stl"), rule)) == count

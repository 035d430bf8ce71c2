import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog

from physgnn.geometry import Surface
from physgnn.geometry.surfaces.intersections import box_pairs, crossing_faces

BASE = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]


def crosses(second: list[list[float]], faces: list[list[int]]) -> bool:
    points = np.array(BASE + second, dtype=float)
    return len(crossing_faces(Surface(points, np.array(faces)))) > 0


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        ([[1, 1, -1], [1, 1, 1], [2, 2, 3]], True),  # through the face
        ([[1, 1, 0.5], [1, 1, 1], [2, 2, 3]], False),  # above
        ([[1, 1, 0], [5, 5, 0], [9, 5, 0]], True),  # in the plane, a corner inside
        ([[3, 3, 0], [5, 5, 0], [9, 5, 0]], False),  # in the plane, apart
        ([[-1, 1, 0], [5, 1, 0], [5, 1.5, 0]], True),  # in the plane, no corner inside
        ([[1, 1, 0], [1, 1, 5], [2, 1, 5]], True),  # a corner touches the face
        ([[2, 0, 0], [2, -1, 1], [3, -1, 1]], True),  # a corner touches an edge
    ],
)
def test_faces_without_a_shared_point(other: list[list[float]], expected: bool) -> None:
    assert crosses(other, [[0, 1, 2], [3, 4, 5]]) is expected


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        ([[-4, 0, 0], [0, -4, 0]], False),  # meet at the point only, one plane
        ([[-4, 0, 3], [0, -4, 3]], False),
        ([[3, 1, 2], [1, 3, -2]], True),  # the far edge pierces the face
        ([[9, 1, 0], [1, 9, 0]], True),  # overlap in the plane
    ],
)
def test_faces_with_one_shared_point(other: list[list[float]], expected: bool) -> None:
    assert crosses(other, [[0, 1, 2], [0, 3, 4]]) is expected


@pytest.mark.parametrize(
    ("apex", "expected"),
    [([2, -3, 0], False), ([1, 1, 2], False), ([3, 3, 0], True)],
)
def test_faces_with_a_shared_edge(apex: list[float], expected: bool) -> None:
    assert crosses([apex], [[0, 1, 2], [1, 0, 3]]) is expected


def meet_by_linear_programme(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two triangles share a point: convex weights that agree."""
    equal = np.vstack([np.hstack([a.T, -b.T]), [1, 1, 1, 0, 0, 0], [0, 0, 0, 1, 1, 1]])
    answer = linprog(np.zeros(6), A_eq=equal, b_eq=[0, 0, 0, 1, 1], bounds=(0, None))
    return bool(answer.status == 0)


@given(st.integers(0, 10_000))
def test_agrees_with_a_linear_programme(seed: int) -> None:
    points = np.random.default_rng(seed).normal(size=(6, 3))
    found = crossing_faces(Surface(points, np.arange(6).reshape(2, 3)))
    assert (len(found) == 1) is meet_by_linear_programme(points[:3], points[3:])


@given(st.integers(0, 10_000), st.integers(2, 40))
def test_box_pairs_are_those_of_brute_force(seed: int, n: int) -> None:
    triangles = np.random.default_rng(seed).uniform(0, 3, (n, 1, 3))
    triangles = triangles + np.random.default_rng(seed + 1).uniform(0, 1, (n, 3, 3))
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    expected = {
        (i, j)
        for i in range(n)
        for j in range(i + 1, n)
        if (low[i] <= high[j]).all() and (low[j] <= high[i]).all()
    }
    assert {tuple(pair) for pair in box_pairs(triangles).tolist()} == expected


def test_a_few_thousand_faces_take_less_than_two_seconds(sphere) -> None:  # type: ignore[no-untyped-def]
    body = sphere(10.0, (0.0, 0.0, 0.0), 4)
    begun = time.process_time()
    assert len(crossing_faces(body)) == 0
    assert body.n_faces == 5120
    assert time.process_time() - begun < 2.0

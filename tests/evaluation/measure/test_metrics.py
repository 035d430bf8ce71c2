"""Errors against the formulas written out node by node."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from physgnn.evaluation.measure.metrics import (
    nodal_errors,
    points_near,
    points_of_region,
)
from physgnn.geometry.tetmesh import TetMesh


def fields(seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(40, 3)), rng.normal(size=(40, 3))


@given(st.integers(0, 2**32 - 1))
def test_formulas(seed: int) -> None:
    truth, predicted = fields(seed)
    errors = nodal_errors(truth, predicted)
    for i in range(len(truth)):
        (a, b, c), (p, q, r) = truth[i], predicted[i]
        assert errors["x"][i] == abs(a - p)
        assert errors["y"][i] == abs(b - q)
        assert errors["z"][i] == abs(c - r)
        distance = math.sqrt((a - p) ** 2 + (b - q) ** 2 + (c - r) ** 2)
        assert errors["euclidean"][i] == pytest.approx(distance)
        sizes = math.hypot(a, b, c), math.hypot(p, q, r)
        assert errors["position"][i] == pytest.approx(abs(sizes[0] - sizes[1]))


@given(st.integers(0, 2**32 - 1))
def test_rotation_leaves_euclidean_and_position(seed: int) -> None:
    truth, predicted = fields(seed)
    turn = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    before = nodal_errors(truth, predicted)
    after = nodal_errors(truth @ turn.T, predicted @ turn.T)
    for name in ("euclidean", "position"):
        np.testing.assert_allclose(after[name], before[name], atol=1e-12)


@given(st.integers(0, 2**32 - 1))
def test_bounds_between_components(seed: int) -> None:
    """Position error ≤ Euclidean error ≤ sum of the components (triangle)."""
    errors = nodal_errors(*fields(seed))
    total = errors["x"] + errors["y"] + errors["z"]
    assert (errors["position"] <= errors["euclidean"] + 1e-12).all()
    assert (errors["euclidean"] <= total + 1e-12).all()


def test_the_truth_has_no_error() -> None:
    truth, _ = fields(0)
    assert all((values == 0).all() for values in nodal_errors(truth, truth).values())


@pytest.mark.parametrize("radius", [0.0, 3.0, 5.5, 100.0])
def test_points_near(block: TetMesh, radius: float) -> None:
    nodes = block.point_set("loaded")[:3]
    apart = block.points[:, None] - block.points[nodes]
    expected = (np.linalg.norm(apart, axis=2) <= radius).any(axis=1)
    found = points_near(block, nodes, radius_mm=radius)
    np.testing.assert_array_equal(found, expected)


def test_points_of_region(block: TetMesh) -> None:
    upper = points_of_region(block, 1)
    assert set(np.flatnonzero(upper)) == set(block.cells[block.region == 1].ravel())
    assert not points_of_region(block, 7).any()

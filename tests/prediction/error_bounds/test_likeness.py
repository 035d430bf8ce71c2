"""A family's bounds hold for bodies like its own."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.bundled import BUNDLED_FAMILY, BUNDLED_RUN
from physgnn.geometry.tetmesh import without_unused_points
from physgnn.io import read_mesh
from physgnn.prediction.error_bounds.likeness import (
    ABOVE,
    BELOW,
    reasons_unlike,
    roundness,
)

CUBE = block_mesh(12, side=120.0)


def test_roundness_of_a_cube_and_of_a_ball_in_it() -> None:
    """Half axes of 5 cov: a sphere of radius a √(5/12), whose caps leave the cube."""
    r = np.sqrt(5.0 / 12.0)
    h = r - 0.5
    sphere, caps = 4 / 3 * np.pi * r**3, 6 * np.pi * h**2 * (3 * r - h) / 3
    expected = 2 * (sphere - caps) / (1 + sphere)
    assert roundness(CUBE) == pytest.approx(expected, abs=0.01)
    near = np.linalg.norm(CUBE.points[CUBE.cells].mean(axis=1) - 60.0, axis=1) < 55.0
    ball, _ = without_unused_points(CUBE.points, CUBE.cells[near], CUBE.region[near])
    assert roundness(ball) > 0.95


def test_roundness_does_not_change_with_size_place_and_stretch() -> None:
    other = replace(CUBE, points=3.0 + CUBE.points * [0.5, 1.3, 2.0])
    assert roundness(other) == pytest.approx(roundness(CUBE), abs=1e-9)


def test_brains_are_alike_and_a_cube_is_none() -> None:
    family = read_mesh(BUNDLED_FAMILY / "case.vtu")
    assert reasons_unlike(read_mesh(BUNDLED_RUN / "case.vtu"), family) == ()
    assert len(reasons_unlike(CUBE, family)) == 1
    (small,) = reasons_unlike(replace(family, points=family.points / 2), family)
    assert "ml (the network learnt from" in small


@pytest.mark.parametrize("run", [BUNDLED_RUN, BUNDLED_FAMILY])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_hemisphere_is_no_brain(run: Path, side: float) -> None:
    """Its volume is a small adult's: 936 to 967 ml; its roundness 0.855 to 0.868."""
    brain, family = read_mesh(run / "case.vtu"), read_mesh(BUNDLED_FAMILY / "case.vtu")
    x = brain.points[:, 0]
    centres = brain.points[brain.cells].mean(axis=1)[:, 0]
    kept = side * (centres - (x.min() + x.max()) / 2) > 0
    half, _ = without_unused_points(brain.points, brain.cells[kept], brain.region[kept])
    (reason,) = reasons_unlike(half, family)
    assert "overlap with an ellipsoid is 0.8" in reason


def test_what_was_measured_on_real_brains_is_alike_and_a_ball_is_not() -> None:
    """Of maps whose folds are filled, 0.88; of a skull-stripped scan, 0.923."""
    family = roundness(read_mesh(BUNDLED_FAMILY / "case.vtu"))
    for real in (0.88, 0.906, 0.923):
        assert -BELOW <= real - family <= ABOVE
    assert 0.97 - family > ABOVE

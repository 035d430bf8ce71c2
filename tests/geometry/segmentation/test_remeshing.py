"""Surfaces of any density become even ones of the same volume."""

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry import Surface, check_nested, check_surface, volume
from physgnn.geometry.segmentation.extract import edge_for
from physgnn.geometry.segmentation.remeshing import remeshed, too_fine
from physgnn.geometry.surface import edge_lengths


def folded(sphere, refinements: int) -> Surface:  # type: ignore[no-untyped-def]
    """Half a brain with gyri: a ball with ripples of 3 mm, flat on one side."""
    ball = sphere(1.0, refinements=refinements)
    x, y, z = ball.points.T
    ripple = 60.0 + 3.0 * np.sin(14.0 * x) * np.sin(14.0 * y) * np.sin(14.0 * z)
    points = ball.points * ripple[:, None]
    points[:, 0] = np.where(points[:, 0] < 0, 0.2 * points[:, 0], points[:, 0])
    return check_surface(Surface(points, ball.faces), "half")[0]


def test_a_hemisphere_of_41_000_points(sphere) -> None:  # type: ignore[no-untyped-def]
    brain = folded(sphere, 6)
    assert brain.n_points > 40_000
    tumour = sphere(9.0, (25, 5, 5), refinements=5)
    said: list[str] = []
    assert too_fine(brain, 5_000)
    new, (inner,) = remeshed(brain, [tumour], 5_000, log=said.append)
    assert check_surface(new, "brain")[1] == []
    check_nested(new, [inner])
    assert volume(new) == pytest.approx(volume(brain), rel=0.005)
    assert volume(inner) == pytest.approx(volume(tumour), rel=0.005)
    wanted = edge_for(volume(brain), 5_000)
    assert edge_lengths(new).mean() == pytest.approx(wanted, rel=0.3)
    assert not too_fine(new, 5_000)
    points = f"brain: a surface of {brain.n_points} points remeshed"
    assert said[0].startswith(points) and "at most 7500 points" in said[0]


def test_surfaces_that_suit_are_no_finer(sphere) -> None:  # type: ignore[no-untyped-def]
    assert not too_fine(sphere(60.0), 5_000)


def test_points_out_of_range_are_refused(sphere) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match="target_points"):
        remeshed(sphere(60.0), [], 10)

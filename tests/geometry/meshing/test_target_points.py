"""Searches for a number of points, with meshers of which only the numbers matter."""

from collections.abc import Callable

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.meshing.target_points import (
    Target,
    mesh_from_coarser,
    mesh_near,
)


class Sized:
    """A mesh of which only the size matters."""

    def __init__(self, n_points: float) -> None:
        self.n_points = round(n_points)


class Mesher:
    """Gives meshes of a size that follows from the cell volume, and notes its runs."""

    def __init__(self, size: Callable[[float], float]) -> None:
        self.size = size
        self.runs: list[int] = []

    def __call__(self, volume: float) -> Sized:
        mesh = Sized(self.size(volume))
        self.runs.append(mesh.n_points)
        return mesh


def in_steps(volume: float) -> float:
    """Return how many points fTetWild makes, nearly: it halves edges until they fit."""
    edge = volume ** (1 / 3)
    halvings = np.log2(100.0 / edge)
    smooth = 0.25 * np.sin(2 * np.pi * halvings) / (2 * np.pi)
    return float(50.0 * 2 ** (3 * 0.94 * (halvings + 3.0 * smooth)))


@pytest.mark.parametrize(
    ("target", "on_surfaces", "runs"), [(5000, 3000, 2), (5000, 6000, 1)]
)
def test_a_search_knows_how_many_points_lie_on_the_surfaces(
    target: int, on_surfaces: int, runs: int
) -> None:
    mesher = Mesher(lambda volume: on_surfaces + 2e5 / volume)
    found = mesh_near(Target(target, 400.0 / 3, 0.01, on_surfaces), mesher)  # type: ignore[arg-type]
    assert len(mesher.runs) == runs
    if runs > 1:
        assert found.n_points == pytest.approx(target, rel=0.01)


@pytest.mark.parametrize("target", [20_000, 35_000, 60_000, 100_000, 150_000])
@pytest.mark.parametrize("off", [0.4, 0.8, 1.3])
def test_a_fine_mesh_is_made_once(target: int, off: float) -> None:
    """Whatever step of fTetWild's numbers the first volume is on."""
    mesher = Mesher(in_steps)
    right = 50.0 ** (1 / 0.94) * 1e6 / target ** (1 / 0.94)
    found = mesh_from_coarser(Target(target, off * right, 0.1), mesher)  # type: ignore[arg-type]
    assert abs(np.log(found.n_points / target)) < 0.1
    assert sum(run > 0.5 * target for run in mesher.runs) == 1
    assert found.n_points == mesher.runs[-1]


def test_surfaces_that_set_the_number_are_no_place_to_search_among() -> None:
    mesher = Mesher(lambda volume: 4000 + 2e5 / volume)
    mesh_from_coarser(Target(24_000, 10.0, 0.1, 4000), mesher)  # type: ignore[arg-type]
    assert mesher.runs == [24_000]


def test_a_number_that_is_not_to_be_had_is_refused() -> None:
    with pytest.raises(InputError, match=r"1000…200000 \(got 999\)"):
        Target(999, 1.0, 0.1)

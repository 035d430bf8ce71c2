"""Shifts of physiology are equilibria of what is left of the body."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from brain_block import CORNER, SIDE, block_of_brain
from physgnn.errors import InputError
from physgnn.evaluation.in_silico.cases import SeenPlaces
from physgnn.evaluation.in_silico.physiological_shifts import (
    SOFT,
    PhysiologicalShift,
    collapse,
    drained,
    sag,
    solved,
)
from physgnn.mechanics import Gravity, LoadPath
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.registration.removed_region import resected

TOP = CORNER + np.array([SIDE / 2, SIDE / 2, SIDE])


@pytest.fixture(scope="module")
def truth() -> Any:
    phantom = SimpleNamespace(craniotomy_point=TOP)
    return SimpleNamespace(mesh=block_of_brain(), phantom=phantom)


@pytest.mark.parametrize("shift", [sag, collapse])
def test_weight_and_stress_are_in_equilibrium(
    truth: Any, shift: PhysiologicalShift
) -> None:
    mesh, u = shift(truth, np.random.default_rng(3))
    gravity = drained(truth, np.random.default_rng(3))
    whole = truth.mesh.cell_volumes.sum()
    gone = resected(truth.mesh, "tumour").removed.cell_volumes.sum()
    left = whole - gone if shift is collapse else whole
    assert mesh.cell_volumes.sum() == pytest.approx(left)
    assert np.linalg.norm(u, axis=1).max() > 0.1
    body = Body(mesh, SOFT)
    weight = gravity.bind(mesh)(u, 1.0)
    inner, inverted = internal_force(body.elements, u)
    free = np.setdiff1d(np.arange(mesh.n_points), mesh.point_set("fixed"))
    assert inverted < 0
    np.testing.assert_array_equal(u[mesh.point_set("fixed")], 0.0)
    off = np.linalg.norm((inner - weight)[free], axis=1).max()
    assert off < 1e-4 * np.linalg.norm(weight[free], axis=1).max()


def test_the_wall_of_a_cavity_is_not_seen(truth: Any) -> None:
    mesh, u = collapse(truth, np.random.default_rng(0))
    places = SeenPlaces(mesh, TOP)
    wall = mesh.point_set("cavity")
    assert len(wall) and not np.isin(wall, places.exposed).any()
    assert not np.isin(wall, places.deep).any()
    case = places.measured(u, np.random.default_rng(1), seed=1)
    off = case.landmarks.displacement - _at(mesh.points, u, case.landmarks.source)
    assert 0.4 < off.std() < 1.1
    depth = np.abs(case.pairs.source - TOP).max(axis=1)
    assert depth.max() <= 30.0


def _at(points: np.ndarray, u: np.ndarray, places: np.ndarray) -> np.ndarray:
    index = [int(np.linalg.norm(points - x, axis=1).argmin()) for x in places]
    return u[index]


def test_a_load_without_equilibrium_is_said(truth: Any) -> None:
    heavy = LoadPath.of(np.ones(1), Gravity((0.0, 0.0, 1.0), density_kg_m3=1e9))
    with pytest.raises(InputError, match="no level came to equilibrium"):
        solved(truth.mesh, heavy, SOFT)

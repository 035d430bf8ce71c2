"""Brains with ventricles: their fluid bears itself, and is pressed flat easily."""

from dataclasses import replace

import numpy as np
import pytest
from block_shifts import NOISE, SIDE, errors, open_box

from physgnn.arrays import FloatArray
from physgnn.geometry.measured import PointPairs
from physgnn.geometry.regions import VENTRICLE
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import TISSUES, LoadPath, RestState, Solver
from physgnn.mechanics.body import Body
from physgnn.registration.registrar import Registrar

MATERIALS = {
    label: TISSUES[name].material
    for label, name in enumerate(("brain", "tumour", "ventricle"))
}


@pytest.fixture(scope="module")
def mesh() -> TetMesh:
    """Two flat ventricles with a thin sheet between them, 30 mm under the top."""
    block = open_box(9)
    middle = np.abs(block.points[block.cells].mean(axis=1) - 0.5 * SIDE)
    inside = (middle[:, 0] > 5) & (middle[:, 0] < 40) & (middle[:, 1] < 40)
    region = np.where(inside & (middle[:, 2] < 20), VENTRICLE, 0)
    return replace(block, region=region.astype(block.region.dtype))


@pytest.fixture(scope="module")
def registrar(mesh: TetMesh) -> Registrar:
    return Registrar(Body(mesh, MATERIALS))


def test_no_dead_force_pushes_the_fluid(mesh: TetMesh, registrar: Registrar) -> None:
    tissue = np.unique(mesh.cells[mesh.region != VENTRICLE])
    fluid = np.setdiff1d(np.arange(mesh.n_points), tissue)
    assert len(fluid) and not registrar.modes.forces[:, fluid].any()


def pressed(mesh: TetMesh, size_mm: float) -> FloatArray:
    """Sink the top by a traction on it, 1 to 2 ventricle heights at the most."""
    top = mesh.point_set("loaded")
    forces = np.zeros_like(mesh.points)
    away = mesh.points[top] - [0.55 * SIDE, 0.45 * SIDE, SIDE]
    forces[top, 2] = -np.exp(-(away**2).sum(axis=1) / 2 / 25**2)
    body = Body(mesh, MATERIALS)
    moved = RestState(body).solve(forces)
    forces *= size_mm / np.linalg.norm(moved, axis=1).max()
    path = LoadPath(top, forces[top], np.linspace(0.2, 1.0, 5))
    found = Solver(body).solve(path)
    assert (found.status == 0).all()
    return found.displacement[-1]


@pytest.mark.parametrize("size_mm", [6.0, 14.0, 20.0])
def test_a_shift_that_presses_ventricles_comes_to_rest(
    size_mm: float, mesh: TetMesh, registrar: Registrar
) -> None:
    u, top = pressed(mesh, size_mm), mesh.point_set("loaded")
    noise = np.random.default_rng(1).normal(scale=NOISE, size=(len(top), 3))
    pairs = PointPairs(mesh.points[top], mesh.points[top] + u[top] + noise)
    found = registrar(pairs, noise_mm=NOISE)
    bound = found.prediction.error_estimate_mm
    assert found.prediction.status.usable and bound is not None
    assert errors(found, u).mean() < 1.0
    assert errors(found, u).max() < bound.max_mm

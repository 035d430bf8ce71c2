"""FEBio as a solver: a stand-in always, FEBio itself where it is installed."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import febio_stand_in
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.febio.run import FebioSolver
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.full_newton import Newton
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.equilibrium.solver import Solver
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}


def load_path(block: TetMesh, force_n: float) -> LoadPath:
    top = block.point_set("loaded")
    return LoadPath(top[5:6], [[0.2 * force_n, 0, -force_n]], np.arange(1, 5) / 4)


def test_the_same_solution(
    block: TetMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    febio_stand_in.put_on_path(tmp_path / "bin", monkeypatch)
    body = Body(block, MATERIALS)
    path = load_path(block, 5e-3)
    found, ours = FebioSolver(body).solve(path), Solver(body).solve(path)
    assert (found.status == Status.CONVERGED).all()
    assert np.allclose(found.displacement, ours.displacement, rtol=1e-11, atol=1e-13)
    assert (found.reached, found.message) == (1.0, "")
    assert found.seconds > 0
    assert list(tmp_path.iterdir()) == [tmp_path / "bin"]


def test_levels_out_of_reach(
    block: TetMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The levels before are kept, and the first that failed says why."""
    febio_stand_in.put_on_path(tmp_path / "bin", monkeypatch)
    body = Body(block, MATERIALS)
    path = load_path(block, 8.0)
    path = LoadPath(path.nodes, path.forces, np.array([0.002, 0.005, 0.8, 1.0]))
    ours = Solver(body).solve(path)
    good = int((ours.status == Status.CONVERGED).sum())
    assert 0 < good < 4
    found = FebioSolver(body).solve(path)
    assert (found.status[:good] == Status.CONVERGED).all()
    assert found.status[good] == Status.INVERTED
    assert (found.status[good + 1 :] == Status.NOT_REACHED).all()
    assert not found.displacement[good:].any()
    assert found.message == f"stopped at load factor {path.load_factors[good - 1]:.4f}"


def test_no_result_at_all(
    block: TetMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    febio_stand_in.put_on_path(tmp_path / "bin", monkeypatch)
    (tmp_path / "bin" / "febio4").write_text("#!/bin/sh\necho no licence; exit 1\n")
    solver = FebioSolver(Body(block, MATERIALS, block.point_set("fixed")))
    with pytest.raises(InputError, match="FEBio ended without a result: no licence"):
        solver.solve(load_path(block, 1e-3))


def test_absent(block: TetMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(InputError, match="no program 'febio4' is on PATH: install"):
        FebioSolver(Body(block, MATERIALS, block.point_set("fixed")))


@pytest.mark.skipif(shutil.which("febio4") is None, reason="FEBio is not installed")
def test_febio_itself(block: TetMesh) -> None:
    fixed = block.point_set("fixed")
    path = load_path(block, 5e-3)
    found = FebioSolver(Body(block, MATERIALS, fixed)).solve(path)
    newton = Newton(Body(block, MATERIALS, fixed))
    for level in range(path.n_levels):
        assert newton.distance(path.case(level), found.displacement[level]) < 1e-6

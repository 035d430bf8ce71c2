"""Down in energy, and no further than what is proven."""

import numpy as np
import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import LoadPath, NeoHookean, Status
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import make_pattern
from physgnn.mechanics.equilibrium.energy_descent import descend
from physgnn.mechanics.equilibrium.quasi_newton import QuasiNewton
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.linear.protocols import LinearSolver
from physgnn.mechanics.loads.external_force import Loading

MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(7500.0, 0.45)}


class Doubting:
    """A solver that calls every factor but the first few not positive definite."""

    def __init__(self, solver: LinearSolver, believed: int) -> None:
        self._solver, self._believed = solver, believed

    def factorize(self, data: np.ndarray) -> bool:
        self._believed -= 1
        return self._solver.factorize(data) and self._believed >= 0

    def solve(self, right: np.ndarray) -> np.ndarray:
        return self._solver.solve(right)


def descent(mesh: TetMesh, believed: int) -> Status:
    fixed, nodes = mesh.point_set("fixed"), mesh.point_set("loaded")
    pattern = make_pattern(mesh.cells, mesh.n_points, fixed)
    path = LoadPath(nodes, np.full((len(nodes), 3), 0.1 / len(nodes)), np.ones(1))
    iteration = QuasiNewton(
        Body(mesh, MATERIALS),
        pattern,
        Doubting(make_linear_solver(pattern), believed),
        Loading(mesh, path, fixed),
        tolerance_mm=1e-3,
        max_iterations=20,
    )
    rest = np.zeros(pattern.n_unknowns)
    return descend(iteration, rest, fallback=rest).status


def test_arrives(block: TetMesh) -> None:
    assert descent(block, believed=99) == Status.CONVERGED


@pytest.mark.parametrize("believed", [0, 1])
def test_an_equilibrium_not_seen_to_be_stable_is_not_taken(
    block: TetMesh, believed: int
) -> None:
    """The factor that led there was fine; that of where it led is not."""
    assert descent(block, believed) == Status.LIMIT_POINT

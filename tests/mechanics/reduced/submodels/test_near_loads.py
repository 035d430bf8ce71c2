"""A force on a point is answered by the equations round it, any other as it was."""

import numpy as np
import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import LoadCase, LoadPath, NeoHookean, SolverOptions, solve
from physgnn.mechanics.body import Body
from physgnn.mechanics.reduced.submodels import near_loads as module
from physgnn.mechanics.reduced.submodels.near_loads import FEW, LEAST_HOPS, NearLoads

MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(7500.0, 0.45)}


def push(block: TetMesh, n_nodes: int) -> LoadCase:
    nodes = block.point_set("loaded")[5 : 5 + n_nodes]
    return LoadCase(nodes, np.tile([4e-3, 0.0, -8e-3], (n_nodes, 1)))


@pytest.mark.parametrize("n_nodes", [1, FEW])
def test_the_cells_under_the_force_follow_from_those_beside_them(
    block: TetMesh, n_nodes: int
) -> None:
    case = push(block, n_nodes)
    path = LoadPath(case.nodes, case.forces, np.ones(1))
    options = SolverOptions(tolerance_mm=1e-8)
    truth = solve(block, path, materials=MATERIALS, options=options).displacement[0]
    near = NearLoads(Body(block, MATERIALS, block.point_set("fixed")), 2)
    wrong = truth.copy()
    wrong[case.nodes] += 2.0
    np.testing.assert_allclose(near.corrected(case, wrong), truth, atol=1e-4)


@pytest.mark.parametrize(
    ("n_nodes", "reach", "element"),
    [(1, 0, "tet4"), (FEW + 1, 2, "tet4"), (1, 2, "tet4-averaged")],
)
def test_other_displacements_are_left_alone(
    block: TetMesh, n_nodes: int, reach: int, element: str
) -> None:
    near = NearLoads(Body(block, MATERIALS, element=element), reach)
    answer = np.full(block.points.shape, 0.1)
    assert near.corrected(push(block, n_nodes), answer) is answer


def test_another_equilibrium_far_off_is_not_taken(
    block: TetMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As where cells snap through: the submesh is in balance, but not near by."""
    near, answer = (
        NearLoads(Body(block, MATERIALS), 4),
        np.full(block.points.shape, 0.1),
    )
    tried, far = [], [0.3]

    def solved(*given: object) -> np.ndarray:
        tried.append(len(given[1]))
        return given[2] + far[0]

    monkeypatch.setattr(module, "solve_submesh", solved)
    assert near.corrected(push(block, 1), answer) is answer
    assert tried == sorted(tried, reverse=True)
    assert len(tried) == 4 - LEAST_HOPS + 1
    far[0] = 0.05
    np.testing.assert_array_equal(near.corrected(push(block, 1), answer), answer + 0.05)

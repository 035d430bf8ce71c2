"""The part that is renewed is the one that has deformed, and costs no accuracy."""

import numpy as np
import pytest

from physgnn.mechanics import LoadPath, NeoHookean, Solver, SolverOptions, Status
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium import continuation, quasi_newton
from physgnn.mechanics.equilibrium.full_newton import Newton
from physgnn.mechanics.equilibrium.partial_renewal import PART, most_deformed

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
FACTORS = np.arange(1, 11) / 10


@pytest.fixture
def in_parts(monkeypatch):
    """Also a small body's factor is renewed in parts."""
    monkeypatch.setattr(quasi_newton, "LEAST_UNKNOWNS", 0)
    monkeypatch.setattr(continuation, "PART_FROM_UNKNOWNS", 0)


def pull(block, total_n):
    nodes = block.point_set("loaded")
    forces = np.tile([0.3, 0.1, 1.0], (len(nodes), 1)) * total_n / len(nodes)
    return LoadPath(nodes, forces, FACTORS)


@pytest.mark.parametrize("element", ["tet4", "tet4-averaged"])
@pytest.mark.parametrize("tolerance_mm", [1e-3, 1e-5])
@pytest.mark.usefixtures("in_parts")
def test_every_level_is_within_the_tolerance(block, element, tolerance_mm):
    body = Body(block, MATERIALS, element=element)
    options = SolverOptions(tolerance_mm=tolerance_mm)
    path = pull(block, 0.2)
    solution = Solver(body, options=options).solve(path)
    assert (solution.status == Status.CONVERGED).all()
    assert solution.counts["partial_renewals"] > 3
    newton = Newton(body)
    for factor, u in zip(FACTORS, solution.displacement, strict=True):
        assert newton.distance(path, u, factor) < tolerance_mm


@pytest.mark.usefixtures("in_parts")
def test_a_limit_point_is_still_one(block):
    """A block pressed far too hard stops, and says where."""
    solution = Solver(Body(block, MATERIALS)).solve(pull(block, -20.0))
    assert not solution.converged
    assert 0 < solution.reached < 1
    assert solution.message


def test_the_part_lies_where_cells_have_changed_shape(block):
    body = Body(block, MATERIALS)
    free = body.pattern.free
    moved = np.zeros_like(block.points)
    moved[free[5]] = [0.0, 0.0, 0.1]
    part = most_deformed(body.elements, free, moved)
    cells = block.cells[(block.cells == free[5]).any(axis=1)]
    assert len(part) == int(PART * len(free))
    assert np.isin(part, cells).all()


def test_a_body_moved_as_a_whole_has_no_part_that_deformed_most(block):
    """Then any points will do: the first are taken, whatever rounding says."""
    body = Body(block, MATERIALS)
    same = np.ones_like(block.points)
    part = most_deformed(body.elements, body.pattern.free, same)
    assert np.isin(part, body.pattern.free).all()
    assert len(part) == int(PART * len(body.pattern.free))

"""Steps neither invert nor overshoot, and the error estimate is on the safe side."""

import numpy as np
import pytest

from physgnn.mechanics import LoadPath, NeoHookean, Solver, SolverOptions, Status
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.full_newton import Newton
from physgnn.mechanics.equilibrium.norms import dot
from physgnn.mechanics.equilibrium.quasi_newton import OVERSHOT
from physgnn.mechanics.loads.external_force import Loading

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}


@pytest.fixture
def path(block):
    nodes = block.point_set("loaded")
    forces = np.tile([0.3, 0.1, 1.0], (len(nodes), 1)) * 0.1 / len(nodes)
    return LoadPath(nodes, forces, np.ones(1))


@pytest.fixture
def iteration(block, path):
    solver = Solver(Body(block, MATERIALS))
    iteration = solver._iteration(Loading(block, path, block.point_set("fixed")))
    assert iteration.refactorize(np.zeros(iteration.pattern.n_unknowns), 0.0)
    return iteration


@pytest.mark.parametrize("times", [0.1, 3.0, 100.0])
def test_a_step_too_long_is_shortened_until_it_is_not(iteration, times):
    start = np.zeros(iteration.pattern.n_unknowns)
    r, _ = iteration.residual(start, 0.01)
    d = times * iteration.direction(r)
    moved, r_new, scale, _ = iteration._step(start, d, r, 0.01)
    assert (scale == 1.0) == (times <= 1.0)
    np.testing.assert_array_equal(moved, start + scale * d)
    assert dot(d, r_new) > -OVERSHOT * dot(d, r)


@pytest.mark.parametrize("tolerance_mm", [1e-2, 1e-4, 1e-6])
def test_converged_means_within_the_tolerance(block, path, tolerance_mm):
    factors = np.arange(1, 6) / 5
    levels = LoadPath(path.nodes, path.forces, factors)
    options = SolverOptions(tolerance_mm=tolerance_mm)
    solution = Solver(Body(block, MATERIALS), options=options).solve(levels)
    assert (solution.status == Status.CONVERGED).all()
    newton = Newton(Body(block, MATERIALS))
    for factor, u in zip(factors, solution.displacement, strict=True):
        assert newton.distance(levels, u, factor) < tolerance_mm

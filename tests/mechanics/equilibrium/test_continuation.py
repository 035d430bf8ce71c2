"""Steps are as long as converge, and what a failure taught is not forgotten."""

from types import SimpleNamespace

import numpy as np
import pytest

from physgnn.mechanics.equilibrium import continuation
from physgnn.mechanics.equilibrium.continuation import PathFollower
from physgnn.mechanics.equilibrium.quasi_newton import Equilibrium
from physgnn.mechanics.equilibrium.solution import Status


class OnlyShortSteps:
    """An iteration that converges for steps up to a length, or goes astray."""

    pattern = SimpleNamespace(n_unknowns=3)

    def __init__(self, longest: float, *, else_astray: bool = False) -> None:
        self.longest, self.reached, self.tried = longest, 0.0, []
        self.else_astray = else_astray
        self.factorised, self.part_is_positive = "", True

    def solve(self, start, load_factor, **_):
        self.tried.append(load_factor)
        if load_factor - self.reached > self.longest:
            if self.else_astray:
                return Equilibrium(1.3 * start, Status.CONVERGED, 0.0)
            return Equilibrium(start, Status.INVERTED, np.inf)
        self.reached = load_factor
        return Equilibrium(self.state(load_factor), Status.CONVERGED, 0.0)

    @staticmethod
    def state(load_factor):
        return (load_factor + 0.05 * load_factor**2) * np.ones(3)

    def refactorize(self, *_):
        self.factorised += "whole "
        return True

    def renew_part(self, *_):
        self.factorised += "part "
        return self.part_is_positive


def walk(iteration, targets, **options):
    follower = PathFollower(iteration, lambda factor: factor * np.ones(3), **options)
    return [follower.advance(target) for target in targets], follower


def test_where_everything_converges_only_the_targets_are_solved():
    iteration = OnlyShortSteps(1.0)
    targets = [0.01, 0.1, 1.0]
    found, follower = walk(iteration, targets, min_step=1e-3)
    assert iteration.tried == targets
    assert [f.status for f in found] == [Status.CONVERGED] * 3
    assert follower.reached == 1.0


def test_a_step_that_failed_is_not_tried_again_at_the_next_target():
    iteration = OnlyShortSteps(0.06)
    targets = np.linspace(0.2, 1.0, 5).tolist()
    found, follower = walk(iteration, targets, min_step=1e-3)
    assert all(f.status == Status.CONVERGED for f in found)
    assert follower.reached == 1.0
    assert set(targets) <= set(iteration.tried)
    after_first = iteration.tried[iteration.tried.index(targets[0]) + 1 :]
    assert after_first[0] < targets[1]
    assert targets[1] in after_first


def test_a_walk_that_cannot_go_on_ends_with_the_reason_and_keeps_its_place():
    iteration = OnlyShortSteps(1e-4)
    (found,), follower = walk(iteration, [1.0], min_step=1e-3)
    assert found.status == Status.INVERTED
    assert follower.reached == 0.0
    assert min(iteration.tried) >= 1e-3


def test_another_equilibrium_than_the_one_the_path_points_at_is_not_taken():
    iteration = OnlyShortSteps(0.06, else_astray=True)
    found, follower = walk(iteration, [0.5, 1.0], min_step=1e-3)
    assert all(f.status == Status.CONVERGED for f in found)
    np.testing.assert_allclose(follower.state, iteration.state(1.0))


def test_where_only_another_equilibrium_is_found_the_path_has_ended():
    iteration = OnlyShortSteps(1e-4, else_astray=True)
    (found,), follower = walk(iteration, [1.0], min_step=1e-3)
    assert found.status == Status.LIMIT_POINT
    assert follower.reached == 0.0


@pytest.mark.parametrize(
    ("large_from", "part_is_positive", "factorised"),
    [(4, True, "whole "), (3, True, "part "), (3, False, "part whole ")],
)
def test_of_a_large_body_only_a_part_is_factorised_after_a_step_that_failed(
    large_from, part_is_positive, factorised, monkeypatch
):
    monkeypatch.setattr(continuation, "PART_FROM_UNKNOWNS", large_from)
    iteration = OnlyShortSteps(0.6)
    iteration.part_is_positive = part_is_positive
    (found,), _ = walk(iteration, [1.0], min_step=1e-3)
    assert found.status == Status.CONVERGED
    assert iteration.factorised == factorised

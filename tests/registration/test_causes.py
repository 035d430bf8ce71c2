"""Physiological causes as load modes: gravity with a level, swelling, a cavity."""

import numpy as np
import pytest
from block_shifts import NOISE, SIDE, errors, measured, open_box

from physgnn.arrays import FloatArray
from physgnn.dataset.membranes import Membranes
from physgnn.errors import InputError
from physgnn.geometry import boundary_points
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import LoadPath, NeoHookean, Solver, SolverOptions
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.growth_rules import GrowthIn
from physgnn.registration.causes import (
    CAUSES,
    collapse_modes,
    gravity_modes,
    modes_of_causes,
    near_swelling,
)
from physgnn.registration.mode_response import ModeResponse
from physgnn.registration.registrar import Registrar
from physgnn.registration.removed_region import resected

MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(6000.0, 0.45)}


def with_tumour(height: float) -> TetMesh:
    box = open_box()
    centres = box.points[box.cells].mean(axis=1)
    tumour = np.linalg.norm(centres - [50, 50, height], axis=1) < 22
    return TetMesh(box.points, box.cells, tumour.astype(np.int32), box.point_sets)


@pytest.fixture(scope="module")
def brain() -> TetMesh:
    """A block in a box, open at the top, with a round tumour below it."""
    return with_tumour(75.0)


@pytest.fixture(scope="module")
def registrar(brain: TetMesh) -> Registrar:
    return Registrar(Body(brain, MATERIALS))


@pytest.fixture(scope="module")
def swollen(brain: TetMesh) -> FloatArray:
    """What swelling around the tumour does, to the last digit."""
    path = LoadPath.of(np.ones(1), GrowthIn(1.12, near="tumour").on(brain))
    exact = SolverOptions(tolerance_mm=1e-8)
    return Solver(Body(brain, MATERIALS), options=exact).solve(path).displacement[0]


def free_of(mesh: TetMesh) -> np.ndarray:
    return np.setdiff1d(boundary_points(mesh), mesh.point_set("fixed"))


def test_gravity_weighs_what_lies_above_the_level(brain: TetMesh) -> None:
    modes = gravity_modes(brain, free_of(brain))
    assert modes is not None and len(modes.forces) == 15
    straight = modes.forces[:3].sum(axis=1)  # levels at 25, 50 and 75 mm of 100
    dry = np.array([0.75, 0.5, 0.25]) * SIDE**3
    np.testing.assert_allclose(straight, dry[:, None] * [0.0, 0.0, -1.0], atol=1e-6)
    under = modes.forces[1][brain.points[:, 2] < 30]
    np.testing.assert_allclose(under, 0, atol=1e-9)
    leaning = modes.forces[3:].sum(axis=1)
    down = -leaning[:, 2] / np.linalg.norm(leaning, axis=1)
    np.testing.assert_allclose(down, np.cos(np.deg2rad(30)), atol=1e-9)


def test_a_body_has_the_causes_that_it_has_sets_for(brain: TetMesh) -> None:
    everything = list(modes_of_causes(brain, free_of(brain), None))
    assert everything == ["gravity", "near-swelling", "brain-swelling"]
    rest = resected(brain, "tumour").remaining
    assert list(modes_of_causes(rest, free_of(rest), None)) == list(CAUSES)
    assert modes_of_causes(brain, free_of(brain), ()) == {}
    with pytest.raises(InputError, match=r"one of gravity, .* \(got 'fever'\)"):
        modes_of_causes(brain, free_of(brain), ("fever",))
    with pytest.raises(InputError, match="nothing that 'collapse' acts on"):
        modes_of_causes(brain, free_of(brain), ("gravity", "collapse"))


def test_tissue_swells_around_the_tumour_or_its_cavity_alike(brain: TetMesh) -> None:
    with_tumour = near_swelling(brain, free_of(brain))
    rest = resected(brain, "tumour").remaining
    without = near_swelling(rest, free_of(rest))
    assert with_tumour is not None and without is not None
    assert not with_tumour.growth[0][brain.region == 1].any()
    np.testing.assert_array_equal(
        with_tumour.growth[0][brain.region == 0], without.growth[0]
    )


def test_the_walls_of_a_cavity_are_drawn_along_their_normals() -> None:
    deep = with_tumour(50.0)
    rest = resected(deep, "tumour").remaining
    modes = collapse_modes(rest, free_of(rest))
    assert modes is not None and len(modes.forces) == 4
    even = modes.forces[0]
    np.testing.assert_allclose(even.sum(axis=0), 0, atol=1e-8)  # a closed surface
    work = (even * rest.points).sum() / 3  # ∮ x·n dA / 3, out of what is left
    gone = deep.cell_volumes[deep.region == 1].sum()
    assert work == pytest.approx(-gone, rel=1e-9)


def test_a_swollen_equilibrium_is_where_steps_end(
    registrar: Registrar, swollen: FloatArray
) -> None:
    """About (u, w) of an equilibrium, a whole step is nothing."""
    modes = registrar.modes
    w = np.zeros(len(modes.family))
    w[-2] = 0.12 / modes.growth[0].max()
    found = ModeResponse(registrar.tangent, modes)(swollen, w)
    assert found is not None
    step = found[1] + np.tensordot(w, found[0], 1)
    assert np.linalg.norm(swollen, axis=1).max() > 1.0
    np.testing.assert_allclose(step, 0, atol=1e-4)


def test_responses_to_growth_are_its_slope_at_rest(
    registrar: Registrar, brain: TetMesh
) -> None:
    small = 1e-3
    path = LoadPath.of(np.ones(1), GrowthIn(1 + small, near="tumour").on(brain))
    exact = SolverOptions(tolerance_mm=1e-9)
    u = Solver(Body(brain, MATERIALS), options=exact).solve(path).displacement[0]
    w = small / registrar.modes.growth[0].max()
    slope = w * registrar.modes.response[-2].astype(np.float64)
    np.testing.assert_allclose(slope, u, atol=5 * small * np.abs(u).max())


def test_causes_help_where_they_are_the_cause(
    registrar: Registrar, brain: TetMesh, swollen: FloatArray
) -> None:
    alone = Registrar(Body(brain, MATERIALS), causes=())
    seen = [measured(brain, swollen, seed) for seed in range(2)]
    with_causes, without = (
        np.mean([errors(one(pairs, noise_mm=NOISE), swollen).mean() for pairs in seen])
        for one in (registrar, alone)
    )
    assert with_causes < 0.9 * without


def test_membranes_hold_or_spring_in_a_registration(
    brain: TetMesh, swollen: FloatArray
) -> None:
    x, y, z = brain.points.T
    inside = (x > 1) & (x < SIDE - 1) & (z > 1) & (z < 60) & (abs(y - 50) < 9)
    sheet = np.flatnonzero(inside)
    mesh = brain.with_point_sets(falx=sheet)
    pairs, moved = measured(mesh, swollen, 0), {}
    for support in ("left-out", "elastic", "held"):
        one = Registrar(Body(mesh, MATERIALS), membranes=Membranes(falx=support))
        u = one(pairs).prediction.displacement
        moved[support] = float(np.linalg.norm(u[sheet], axis=1).mean())
    assert moved["held"] == 0.0
    assert moved["elastic"] < 0.9 * moved["left-out"]
    with pytest.raises(InputError, match="no point set 'falx'"):
        Registrar(Body(brain, MATERIALS), membranes=Membranes(falx="held"))

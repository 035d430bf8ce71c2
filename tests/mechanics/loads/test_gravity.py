"""Weight and buoyancy: exact volumes under water, reactions that carry the weight."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.mechanics import Gravity, LoadPath, NeoHookean, SolverOptions, solve
from physgnn.mechanics.elements.tet4 import internal_force, make_elements
from physgnn.mechanics.loads.gravity import STANDARD_GRAVITY, submerged_volumes

MESH = block_mesh(2, jitter=0.15)
MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(3000.0, 0.45)}
WEIGHT = 1e-9 * STANDARD_GRAVITY * 1000 * 10**3  # of the 10 mm cube, N
DOWN = (0.0, 0.0, -1.0)


@given(level=st.floats(-2.0, 12.0))
def test_the_submerged_part_of_a_cube_is_exact(level):
    volumes = submerged_volumes(MESH.points, MESH.cells, level - MESH.points[:, 2])
    assert volumes.sum() == pytest.approx(100 * np.clip(level, 0, 10), abs=1e-9)
    assert (volumes >= 0).all() and (volumes <= MESH.cell_volumes + 1e-12).all()


@given(seed=st.integers(0, 10_000))
def test_what_is_under_water_and_what_is_above_make_the_whole(seed):
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=3)
    depth = (MESH.points - rng.uniform(2, 8, 3)) @ normal
    parts = [
        submerged_volumes(MESH.points, MESH.cells, sign * depth) for sign in (1, -1)
    ]
    np.testing.assert_allclose(sum(parts), MESH.cell_volumes, atol=1e-11)


@pytest.mark.parametrize("level", [None, 4.0])
def test_reactions_carry_the_weight_less_the_buoyancy(level):
    gravity = Gravity(DOWN, fluid_level_mm=level, fluid_density_kg_m3=900.0)
    path = LoadPath.of(np.array([0.5, 1.0]), gravity)
    options = SolverOptions(tolerance_mm=1e-9)
    solution = solve(MESH, path, materials=MATERIALS, options=options)
    assert solution.converged
    u = solution.displacement[-1]
    force, _ = internal_force(make_elements(MESH, MATERIALS), u)
    load = gravity.bind(MESH)(u, 1.0)
    fixed = MESH.point_set("fixed")
    reaction = (force - load)[fixed].sum(axis=0)
    x = MESH.points + u
    depth = (-np.inf if level is None else level) - x[:, 2]
    wet = 0.0 if level is None else submerged_volumes(x, MESH.cells, depth).sum()
    expected = WEIGHT - 1e-9 * STANDARD_GRAVITY * 900 * wet
    np.testing.assert_allclose(reaction, [0, 0, expected], atol=1e-10)


def test_a_neutral_body_under_water_stays_where_it_is():
    force = Gravity(DOWN, fluid_level_mm=50.0).bind(MESH)(np.zeros((27, 3)), 1.0)
    np.testing.assert_allclose(force, 0, atol=1e-18)


def test_draining_the_fluid_makes_the_body_sag():
    sag = []
    for level in (10.0, 5.0, 0.0):
        path = LoadPath.of(np.array([1.0]), Gravity(DOWN, fluid_level_mm=level))
        u = solve(MESH, path, materials=MATERIALS).displacement[-1]
        sag.append(-u[MESH.point_set("loaded"), 2].mean())
    assert sag[0] == pytest.approx(0, abs=1e-3)
    assert sag[2] > sag[1] > sag[0] + 1e-3


def test_direction_turns_the_pull_and_its_length_does_not_matter():
    u = np.zeros_like(MESH.points)
    force = Gravity((3.0, 0.0, 4.0)).bind(MESH)(u, 0.5).sum(axis=0)
    np.testing.assert_allclose(force, 0.5 * WEIGHT * np.array([0.6, 0, 0.8]))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"direction": (0.0, 0.0, 0.0)}, "direction must be three numbers"),
        ({"direction": DOWN, "density_kg_m3": 0.0}, "must be > 0"),
        ({"direction": DOWN, "fluid_level_mm": np.inf}, "fluid_level_mm"),
    ],
)
def test_wrong_gravity_is_refused(options, message):
    with pytest.raises(InputError, match=message):
        Gravity(**options)

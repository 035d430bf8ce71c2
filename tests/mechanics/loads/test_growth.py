"""Tissue that swells or contracts, as a load of a path."""

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.mechanics import (
    Body,
    LoadPath,
    NeoHookean,
    Ogden,
    PrescribedDisplacement,
    SolverOptions,
    VolumeGrowth,
    deformation_gradient,
    solve,
)
from physgnn.mechanics.elements.tet4 import ELEMENTS
from physgnn.mechanics.equilibrium.full_newton import Newton

MESH = block_mesh(3, jitter=0.15)
MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: Ogden((1684.0,), (-4.7,), 4e4)}
EXACT = SolverOptions(tolerance_mm=1e-9)
ALL = np.arange(MESH.n_cells)


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("theta", [0.9, 1.2])
def test_a_body_that_nothing_holds_back_becomes_larger_by_the_cube_root(element, theta):
    """Held in one corner; two others are put where free swelling takes them."""
    g = theta ** (1 / 3)
    far = np.argsort(MESH.points.sum(axis=1))[-1:]
    others = np.concatenate([far, np.flatnonzero((MESH.points == [10, 0, 0]).all(1))])
    places = PrescribedDisplacement(others, (g - 1) * MESH.points[others])
    path = LoadPath.of(np.ones(1), VolumeGrowth(ALL, theta), places)
    corner = np.flatnonzero((MESH.points == 0).all(axis=1))
    found = solve(
        MESH, path, materials=MATERIALS, fixed=corner, element=element, options=EXACT
    )
    assert found.converged
    np.testing.assert_allclose(
        MESH.points + found.displacement[0], g * MESH.points, atol=1e-7
    )


@pytest.mark.parametrize("element", ELEMENTS)
def test_growth_goes_with_the_load_factor_and_ends_where_newton_does(element):
    upper = np.flatnonzero(MESH.region == 1)
    factors = np.array([0.5, 1.0])
    path = LoadPath.of(factors, VolumeGrowth(upper, 1.2))
    found = solve(MESH, path, materials=MATERIALS, element=element, options=EXACT)
    assert found.converged and (found.residual < 1e-6).all()
    half = LoadPath.of(np.ones(1), VolumeGrowth(upper, 1.1))
    at_half = solve(MESH, half, materials=MATERIALS, element=element, options=EXACT)
    np.testing.assert_allclose(
        found.displacement[0], at_half.displacement[0], atol=1e-7
    )
    newton = Newton(Body(MESH, MATERIALS, element=element))
    assert newton.distance(path, found.displacement[1]) < 1e-7
    J = np.linalg.det(deformation_gradient(MESH, found.displacement[1]))
    swollen = np.average(J[upper], weights=MESH.cell_volumes[upper])
    assert 1.1 < swollen < 1.2  # what is held below resists a little


def test_two_growths_multiply_and_one_undoes_the_other():
    path = LoadPath.of(np.ones(1), VolumeGrowth(ALL, 1.25), VolumeGrowth(ALL, 0.8))
    found = solve(MESH, path, materials=MATERIALS, options=EXACT)
    np.testing.assert_allclose(found.displacement, 0, atol=1e-9)


@pytest.mark.parametrize(
    ("cells", "ratio", "said"),
    [
        ([0], 2.5, r"0\.5…2.*got 2\.5"),
        ([0, 1], [1.1, 0.4], r"got 0\.4"),
        ([0], np.nan, "got nan"),
        ([0, 0], 1.1, "once"),
        ([], 1.1, "one cell"),
        ([0, 1], [1.1, 1.1, 1.1], "shape"),
    ],
)
def test_what_tissue_cannot_do_is_refused(cells, ratio, said):
    with pytest.raises(InputError, match=said):
        VolumeGrowth(np.array(cells, dtype=np.int64), ratio)


def test_a_cell_that_the_mesh_has_not_is_refused():
    path = LoadPath.of(np.ones(1), VolumeGrowth(np.array([MESH.n_cells]), 1.1))
    with pytest.raises(InputError, match="cells that grow"):
        solve(MESH, path, materials=MATERIALS)

"""The term of finite rotation and strain, against motions that are known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.elements.tet4 import Elements, internal_force, make_elements
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.reduced.expansions.exponential import (
    LARGE,
    SMALL,
    ExponentialTerm,
    GradientFit,
    _exponential,
)

SPIN = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])


@pytest.fixture
def elements(block: TetMesh) -> Elements:
    return make_elements(block, {r: NeoHookean(3000.0, 0.3) for r in (0, 1)})


@pytest.fixture
def places(block: TetMesh) -> FloatArray:
    """Where points are from a corner."""
    at: FloatArray = block.points - block.points.min(axis=0)
    return at


@pytest.fixture
def free(block: TetMesh) -> IntArray:
    points: IntArray = np.setdiff1d(np.arange(block.n_points), block.point_set("fixed"))
    return points


@pytest.fixture
def off_axis(places: FloatArray) -> IntArray:
    """All points but those on the axis of the spin, which do not move with it."""
    return np.flatnonzero((places @ SPIN.T).any(axis=1))


def random_field(n_points: int, free: IntArray, seed: int) -> FloatArray:
    field = np.zeros((n_points, 3))
    field[free] = np.random.default_rng(seed).normal(size=(len(free), 3))
    return field


def test_fits_a_displacement_that_has_the_gradient(
    elements: Elements, free: IntArray
) -> None:
    u = random_field(elements.n_points, free, 0)
    gradient = np.einsum("eai,eaj->eij", u[elements.cells], elements.gradients)
    flux = elements.volumes[:, None, None] * elements.gradients
    divergence = np.zeros_like(u)
    np.add.at(divergence, elements.cells, np.einsum("eij,eaj->eai", gradient, flux))
    np.testing.assert_allclose(GradientFit(elements, free)(divergence), u, atol=1e-4)


@pytest.mark.parametrize("angle", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("before", [0.0, 0.7])
def test_the_series_of_a_rotation_becomes_the_rotation(
    elements: Elements,
    places: FloatArray,
    off_axis: IntArray,
    angle: float,
    before: float,
) -> None:
    here = places @ expm(before * SPIN).T
    first, second = angle * here @ SPIN.T, angle**2 / 2 * here @ (SPIN @ SPIN).T
    fit = GradientFit(elements, off_axis)
    third = ExponentialTerm(elements, here - places, fit)(first, second)
    turned = here @ expm(angle * SPIN).T - here
    missed = np.abs(first + second - turned).max()
    assert missed > 0.1 * angle**3
    assert np.abs(first + second + third - turned).max() < 1e-2 * missed + 1e-5


def test_is_of_third_order(elements: Elements, free: IntArray) -> None:
    first, second = (random_field(elements.n_points, free, seed) for seed in (1, 2))
    none = np.zeros_like(first)
    add = ExponentialTerm(elements, none, GradientFit(elements, free))
    strain = np.einsum("eai,eaj->eij", first[elements.cells], elements.gradients)
    moved = np.linalg.norm(strain, axis=(1, 2))
    least = 1.01 * SMALL / moved[moved > 0].min()  # no cell that moves is left out
    sizes = least * np.array([1.0, 1.3])
    assert (sizes.max() * moved < LARGE).all()
    found = [np.abs(add(s * first, 0.1 * s**2 * second)).max() for s in sizes]
    rate = np.log(found[1] / found[0]) / np.log(sizes[1] / sizes[0])
    assert 2.5 < rate < 3.5


def test_small_loads_have_none(elements: Elements, free: IntArray) -> None:
    first = random_field(elements.n_points, free, 3)
    none = np.zeros_like(first)
    add = ExponentialTerm(elements, none, GradientFit(elements, free))
    assert (add(1e-3 * SMALL * first, none) == 0).all()


def test_however_large_a_load_cells_stretch_by_no_more_than_the_limit(
    elements: Elements, places: FloatArray, off_axis: IntArray
) -> None:
    first = 300.0 * places * [1.0, 0.0, 0.0]
    second = places @ np.diag([300.0**2, 0.0, 0.0])  # log: 300 + 300² − 300²/2
    fit = GradientFit(elements, off_axis)
    third = ExponentialTerm(elements, np.zeros_like(places), fit)(first, second)
    stretched = (np.exp(LARGE) - 1) * places * [1.0, 0.0, 0.0]
    missed = np.abs(first + second + third - stretched).max()
    assert missed < 1e-5 * np.abs(second).max()  # single precision


def test_squeezes_cells_that_the_series_inverts(
    elements: Elements, places: FloatArray, off_axis: IntArray
) -> None:
    first, none = -1.2 * places * [1.0, 0.0, 0.0], np.zeros_like(places)
    assert internal_force(elements, first)[1] >= 0
    fit = GradientFit(elements, off_axis)
    # log(1 + s x) = s x − (s x)²/2: the series of what ends at e^(−1.2 − 0.72)
    third = ExponentialTerm(elements, none, fit)(first, none)
    assert internal_force(elements, first + third)[1] < 0
    squeezed = (np.exp(-1.92) - 1) * places * [1.0, 0.0, 0.0]
    np.testing.assert_allclose(first + third, squeezed, atol=1e-3)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.floats(-LARGE / 3, LARGE / 3), min_size=9, max_size=9))
def test_exponential_of_a_matrix(entries: list[float]) -> None:
    M = np.array(entries).reshape(3, 3)
    E, exact = np.empty((3, 3)), expm(M)
    _exponential(M.copy(), E, np.empty((3, 3)))
    np.testing.assert_allclose(E, exact, atol=1e-4 * np.abs(exact).max())

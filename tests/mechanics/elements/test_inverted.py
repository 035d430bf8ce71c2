"""The continued force: the true one where there is one, smooth beyond."""

import numpy as np
import pytest

from physgnn.mechanics import NeoHookean
from physgnn.mechanics.elements.inverted import extrapolated_force
from physgnn.mechanics.elements.tet4 import internal_force, make_elements

MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(7500.0, 0.45)}


@pytest.fixture(scope="module")
def elements(block):
    return make_elements(block, MATERIALS)


def test_is_the_internal_force_of_sound_states(block, elements):
    u = 0.2 * np.random.default_rng(0).normal(size=block.points.shape)
    expected, inverted = internal_force(elements, u)
    assert inverted < 0
    force, n_inverted = extrapolated_force(elements, u)
    np.testing.assert_array_equal(force, expected)
    assert n_inverted == 0


def test_goes_on_without_a_jump_through_inversion(block, elements):
    """Flattened and turned inside out along z; steps shrink with the increments."""
    flat = np.zeros_like(block.points)

    def force(squeeze: float) -> np.ndarray:
        flat[:, 2] = -squeeze * block.points[:, 2]
        return extrapolated_force(elements, flat)[0]

    assert extrapolated_force(elements, flat)[1] == 0
    largest = []
    for n in (200, 400):
        states = [force(s) for s in np.linspace(0.8, 1.2, n + 1)]
        jumps = np.linalg.norm(np.diff(states, axis=0), axis=(1, 2))
        largest.append(jumps.max())
    assert largest[1] == pytest.approx(largest[0] / 2, rel=0.1)
    assert extrapolated_force(elements, flat)[1] == len(elements.cells)


def test_pushes_back_harder_the_deeper_the_inversion(block, elements):
    work = []
    for squeeze in (0.5, 0.9, 1.1, 1.5):
        u = np.zeros_like(block.points)
        u[:, 2] = -squeeze * block.points[:, 2]
        work.append(float((extrapolated_force(elements, u)[0] * u).sum()))
    assert (np.diff(work) > 0).all()

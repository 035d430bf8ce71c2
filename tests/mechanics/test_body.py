"""The finite-element problem is complete and consistent once it is made."""

import pickle

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import Body, NeoHookean
from physgnn.mechanics.elements.tangent import make_pattern
from physgnn.mechanics.elements.tet4 import make_elements

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}


def test_points_held_by_name_and_by_index_are_the_same(block: TetMesh) -> None:
    held = block.point_set("fixed")
    shuffled = np.concatenate([held[::-1], held[:2]])
    for body in (Body(block, MATERIALS), Body(block, MATERIALS, shuffled)):
        np.testing.assert_array_equal(body.fixed, np.unique(held))


def test_what_cannot_be_solved_is_refused(block: TetMesh) -> None:
    with pytest.raises(InputError, match=r"region 1 has no material .*\[0\]"):
        Body(block, {0: MATERIALS[0]})
    with pytest.raises(InputError, match=r"one of tet4, tet4-averaged .*'hex8'"):
        Body(block, MATERIALS, element="hex8")
    with pytest.raises(InputError, match=r"three points .*got 2"):
        Body(block, MATERIALS, np.array([1, 2, 2])).pattern  # noqa: B018
    with pytest.raises(InputError, match="fixed points must index"):
        Body(block, MATERIALS, np.array([-1, 0, 1]))
    with pytest.raises(InputError, match="no point set 'skull'"):
        Body(block, MATERIALS, "skull")


@pytest.mark.parametrize("element", ["tet4", "tet4-averaged"])
def test_elements_and_pattern_are_made_once_and_are_those_of_the_parts(
    block: TetMesh, element: str
) -> None:
    body = Body(block, MATERIALS, element=element)
    assert body.elements is body.elements and body.pattern is body.pattern
    elements = make_elements(block, MATERIALS, element)
    np.testing.assert_array_equal(body.elements.constants, elements.constants)
    for held in (np.empty(0, dtype=np.int64), block.point_set("loaded")):
        still = np.union1d(body.fixed, held)
        expected = make_pattern(block.cells, block.n_points, still, elements.averaging)
        found = body.pattern_holding(still)
        for name in ("free", "indptr", "indices", "slot", "group_slot"):
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))


def test_a_copy_goes_without_what_was_made(block: TetMesh, tmp_path) -> None:
    body = Body(block, MATERIALS, element="tet4-averaged", factors=tmp_path)
    assert body.pattern.n_unknowns > 0
    copy = pickle.loads(pickle.dumps(body))
    assert "elements" not in vars(copy) and "pattern" not in vars(copy)
    np.testing.assert_array_equal(copy.fixed, body.fixed)
    assert (copy.element, copy.factors) == (body.element, tmp_path)

"""A region taken out: what is left, and where it went."""

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.mechanics import remove_region


def test_what_is_left_is_the_other_region(block):
    left, index = remove_region(block, 1)
    kept = np.flatnonzero(index >= 0)
    np.testing.assert_array_equal(left.points, block.points[kept])
    np.testing.assert_array_equal(index[kept], np.arange(left.n_points))
    below = block.cells[block.region == 0]
    np.testing.assert_array_equal(left.cells, index[below])
    assert (left.region == 0).all()
    assert left.cell_volumes.sum() == block.cell_volumes[block.region == 0].sum()
    assert len(np.unique(left.cells)) == left.n_points, "no orphans"


def test_point_sets_keep_their_names_and_their_points(block):
    left, index = remove_region(block, 1)
    assert set(left.point_sets) == set(block.point_sets)
    for name, ids in left.point_sets.items():
        before = block.point_set(name)
        expected = block.points[before[index[before] >= 0]]
        np.testing.assert_array_equal(left.points[ids], expected)
    assert len(left.point_set("fixed")) == len(block.point_set("fixed"))


@pytest.mark.parametrize("label", [7])
def test_a_region_that_is_not_there_is_refused(block, label):
    with pytest.raises(InputError, match=r"has regions \[0, 1\]"):
        remove_region(block, label)


def test_the_last_region_stays(block):
    left, _ = remove_region(block, 1)
    with pytest.raises(InputError, match="cannot be removed"):
        remove_region(left, 0)

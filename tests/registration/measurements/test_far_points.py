"""Places that no head can have are refused before anything is searched for."""

import pytest
from block_shifts import MATERIALS, open_box

from physgnn.errors import InputError
from physgnn.geometry.measured import PointPairs
from physgnn.mechanics.body import Body
from physgnn.registration.measurements.points import HEAD_MM, measured_pairs


@pytest.mark.parametrize("mm", [301.0, 3000.0, 1e6])
def test_a_place_that_moved_farther_than_a_head_is_long_is_named(mm: float) -> None:
    """At 3 m the algebra behind the offset found no eigenvalues."""
    mesh = open_box()
    source = mesh.points[mesh.point_set("loaded")]
    target = source.copy()
    target[4, 0] += mm
    labels = tuple(f"P{i}" for i in range(len(source)))
    body = Body(mesh, MATERIALS)
    with pytest.raises(InputError, match=f"'P4' first, lie {mm:.0f} mm from where"):
        measured_pairs(body, PointPairs(source, target, labels))
    target[4, 0] = source[4, 0] + HEAD_MM - 1
    assert measured_pairs(body, PointPairs(source, target, labels)).labels == labels

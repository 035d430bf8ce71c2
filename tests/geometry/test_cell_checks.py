"""Meshes mutated at random are refused in a line, or are what a solver can use."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.cell_checks import connected_cells
from physgnn.geometry.tetmesh import TetMesh, without_unused_points
from physgnn.mechanics import Body, NeoHookean, RestState

MESH = block_mesh(2, jitter=0.2)
MATERIALS = dict.fromkeys((0, 1), NeoHookean(3000.0, 0.45))
Parts = dict[str, np.ndarray]


def parts() -> Parts:
    return {
        "points": MESH.points.copy(),
        "cells": MESH.cells.astype(np.int64),
        "region": MESH.region.copy(),
    }


def shifted(at: Parts, i: int, j: int) -> None:
    at["cells"][i % len(at["cells"]), j % 4] += 2**32


def repeated_corner(at: Parts, i: int, j: int) -> None:
    cell = at["cells"][i % len(at["cells"])]
    cell[j % 4] = cell[(j + 1) % 4]


def other_corner(at: Parts, i: int, j: int) -> None:
    at["cells"][i % len(at["cells"]), i % 4] = j % len(at["points"])


def cell_twice(at: Parts, i: int, j: int) -> None:
    again = at["cells"][i % len(at["cells"])][[[0, 1, 2, 3], [1, 2, 0, 3]][j % 2]]
    at["cells"] = np.concatenate([at["cells"], again[None]])
    at["region"] = np.append(at["region"], 0)


def cell_gone(at: Parts, i: int, j: int) -> None:
    gone = [i % len(at["cells"]), j % len(at["cells"])]
    at["cells"] = np.delete(at["cells"], gone, axis=0)
    at["region"] = np.delete(at["region"], gone)


def point_moved(at: Parts, i: int, j: int) -> None:
    at["points"][i % len(at["points"])] = [np.nan, np.inf, 1e300, 1e8, 3.0, -4.0][j % 6]


def point_more(at: Parts, i: int, j: int) -> None:
    new = at["points"][i % len(at["points"])] + j % 3
    at["points"] = np.concatenate([at["points"], new[None]])


def points_lost(at: Parts, i: int, j: int) -> None:
    at["points"] = np.delete(at["points"], np.arange(j % 4, j % 4 + i % 4), axis=0)


def turned_over(at: Parts, i: int, j: int) -> None:
    cell = at["cells"][i % len(at["cells"])]
    one, two = j % 4, (j + 1) % 4
    cell[[one, two]] = cell[[two, one]]


def torn(at: Parts, i: int, j: int) -> None:
    """Later cells have points of their own, as in meshes that were not merged."""
    later = slice(i % len(at["cells"]), None, 1 + j % 2)
    own, index = np.unique(at["cells"][later], return_inverse=True)
    at["cells"][later] = len(at["points"]) + index.reshape(-1, 4)
    at["points"] = np.concatenate([at["points"], at["points"][own % len(at["points"])]])


def region_unknown(at: Parts, i: int, j: int) -> None:
    at["region"] = at["region"].astype(float)
    at["region"][i % len(at["region"])] = [np.nan, 0.5, 1e12, 1.0][j % 4]


MUTATIONS: tuple[Callable[[Parts, int, int], None], ...] = (
    shifted, repeated_corner, other_corner, cell_twice, cell_gone, point_moved,
    point_more, points_lost, turned_over, torn, region_unknown,
)  # fmt: skip
numbers = st.integers(0, 10_000)


@given(st.lists(st.tuples(st.sampled_from(MUTATIONS), numbers, numbers), max_size=3))
@example([(cell_gone, 0, 1)])
@settings(max_examples=300)
def test_a_mutated_mesh_is_refused_or_can_be_solved(steps) -> None:  # type: ignore[no-untyped-def]
    at = parts()
    for mutate, i, j in steps:
        mutate(at, i, j)
    fixed = np.flatnonzero(np.abs(at["points"][:, 2]) < 1e-9)
    try:
        mesh = TetMesh(**at, point_sets={"fixed": fixed})
        body = Body(mesh, MATERIALS)
        rest = RestState(body)  # asks whether the body is held
    except InputError as error:
        assert "\n" not in str(error)
        return
    force = np.zeros_like(mesh.points)
    force[-1] = 1e-6
    force[body.fixed] = 0.0
    displacement = rest.solve(force)
    assert np.isfinite(displacement).all()
    assert (mesh.cell_volumes > 0).all()


@pytest.mark.parametrize(
    ("mutate", "message"),
    [
        (shifted, "cells must index 0…26"),
        (repeated_corner, "four different points .1 do not, the first is cell 3"),
        (cell_twice, "cells 3 and 48 are the same"),
        (turned_over, "cells must have positive volume .cell 3"),
        (point_more, r"every point must belong to a cell .1 do not: 27; the first at"),
    ],
)
def test_refusals_name_the_place(mutate, message: str) -> None:  # type: ignore[no-untyped-def]
    at = parts()
    mutate(at, 3, 1)
    with pytest.raises(InputError, match=message):
        TetMesh(**at)


def test_two_cells_on_one_side_of_a_face_overlap() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.2, 0.2, 2.0]])
    cells = np.array([[0, 1, 2, 3], [0, 1, 2, 4]])
    with pytest.raises(InputError, match=r"cells 0 and 1 overlap .*face \[0, 2, 1\]"):
        TetMesh(points, cells, np.zeros(2))
    points[4, 2] = -2.0
    apart = TetMesh(points, [[0, 1, 2, 3], [0, 2, 1, 4]], np.zeros(2))
    assert connected_cells(apart.cells).tolist() == [0, 0]


def test_cells_are_connected_by_whole_faces() -> None:
    step = np.array([10.0, 0.0, 0.0])
    points = np.concatenate([MESH.points, MESH.points + step])
    cells = np.concatenate([MESH.cells, MESH.cells + MESH.n_points])
    assert connected_cells(MESH.cells).max() == 0
    assert connected_cells(cells).tolist() == [0] * 48 + [1] * 48
    _, index = np.unique(points.round(6), axis=0, return_inverse=True)
    assert connected_cells(index.reshape(-1)[cells]).max() == 0


def test_dropping_unused_points_keeps_fields_and_sets_aligned() -> None:
    at = parts()
    places = [0, 5, 5, 27]
    points = np.insert(at["points"], places, 99.0, axis=0)
    new = np.setdiff1d(np.arange(31), np.array(places) + np.arange(4))
    sets = {"fixed": np.append(new[MESH.point_set("fixed")], 0)}
    mesh, used = without_unused_points(points, new[at["cells"]], at["region"], sets)
    np.testing.assert_array_equal(mesh.points, MESH.points)
    np.testing.assert_array_equal(mesh.cells, MESH.cells)
    np.testing.assert_array_equal(points[used], mesh.points)
    np.testing.assert_array_equal(mesh.point_set("fixed"), MESH.point_set("fixed"))
    assert mesh.content_hash == MESH.content_hash

"""NumPy arrays: what is missing or of another size is named."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.array_files import read_arrays, write_arrays
from physgnn.mechanics.equilibrium.solution import Status


@pytest.fixture
def arrays(block: TetMesh) -> dict[str, Any]:
    """Two load paths, of one and two nodes, the second's last level lost."""
    displacement = np.random.default_rng(0).normal(size=(2, 3, block.n_points, 3))
    displacement[1, 2] = np.nan
    top = block.point_set("loaded")
    return {
        "points": block.points,
        "cells": block.cells,
        "region": block.region,
        "fixed": block.point_set("fixed"),
        "load_nodes": np.array([[top[3], -1], [top[1], top[0]]]),
        "load_vectors": np.arange(1.0, 13).reshape(2, 2, 3),
        "load_factors": np.array([0.2, 0.5, 1.0]),
        "displacement": displacement,
    }


def test_what_is_read(arrays: dict[str, Any], tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", **arrays)
    first, second = read_arrays(tmp_path / "a.npz")
    assert first.load_path.nodes.tolist() == arrays["load_nodes"][0, :1].tolist()
    assert np.array_equal(first.load_path.forces, [[1, 2, 3]])
    assert np.array_equal(second.load_path.forces, arrays["load_vectors"][1])
    assert np.array_equal(first.read_solution().displacement, arrays["displacement"][0])
    solution = second.read_solution()
    assert solution.status.tolist() == [0, 0, Status.ITERATION_LIMIT]
    assert (solution.reached, solution.message) == (
        0.5,
        "stopped at load factor 0.5000",
    )
    assert not solution.displacement[2].any()


def test_round_trip(arrays: dict[str, Any], tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", **arrays)
    write_arrays(tmp_path / "b.npz", read_arrays(tmp_path / "a.npz"))
    again = np.load(tmp_path / "b.npz")
    assert set(again) == set(arrays)
    for name in set(arrays) - {"load_vectors"}:
        assert np.array_equal(again[name], arrays[name], equal_nan=True), name
    used = arrays["load_nodes"] >= 0
    assert np.array_equal(again["load_vectors"][used], arrays["load_vectors"][used])


def test_one_path_needs_no_axis_for_it(arrays: dict[str, Any], tmp_path: Path) -> None:
    for name in ("load_nodes", "load_vectors", "displacement"):
        arrays[name] = arrays[name][1]
    np.savez(tmp_path / "a.npz", **arrays)
    (only,) = read_arrays(tmp_path / "a.npz")
    assert np.array_equal(only.load_path.nodes, arrays["load_nodes"])


@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        ("load_vectors", None, "has no array 'load_vectors' (it has: points"),
        (
            "displacement",
            lambda a: a[:, :, :-1],
            "displacement must have shape (2, 3,",
        ),
        ("displacement", lambda a: a[:, :2], "displacement must have shape (2, 3,"),
        ("displacement", lambda a: a[0, 0], "displacement must have 4 axes"),
        ("load_vectors", lambda a: a[:, :1], "load_vectors must have shape (2, 2, 3)"),
        ("load_factors", lambda a: a[::-1], "load_factors must increase strictly"),
        ("cells", lambda a: a + 1, "cells must index 0…63 (got 1…64)"),
    ],
)
def test_what_does_not_fit(
    arrays: dict[str, Any], tmp_path: Path, name: str, change: Any, message: str
) -> None:
    value = arrays.pop(name)
    if change is not None:
        arrays[name] = change(value)
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(InputError) as error:
        read_arrays(tmp_path / "a.npz")
    assert message in str(error.value)
    assert str(error.value).startswith(str(tmp_path / "a.npz"))


def test_no_arrays(tmp_path: Path) -> None:
    (tmp_path / "a.npz").write_text("points")
    with pytest.raises(InputError, match=r"expected arrays in an \.npz file"):
        read_arrays(tmp_path / "a.npz")
    with pytest.raises(InputError, match=r"written as \.npz"):
        write_arrays(tmp_path / "a.npy", [])

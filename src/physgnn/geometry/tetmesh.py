"""Tetrahedral meshes: the domain type that every later stage shares."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.array_checks import (
    checked_indices,
    checked_labels,
    checked_points,
)
from physgnn.geometry.cell_checks import (
    check_corners,
    check_faces,
    check_used,
    check_volumes,
)


def shape_gradients(points: FloatArray, cells: NDArray[np.integer[Any]]) -> FloatArray:
    """Return ∂N_a/∂X of the four corners of cells, (n_cells, 4, 3), 1/mm.

    N_a is linear, one at corner a and zero at the others: ∂N/∂X of the last three are
    the rows of (x₁ − x₀, x₂ − x₀, x₃ − x₀)⁻¹, edges in columns, and all four add up to
    nothing.
    """
    x = points[cells]
    last = np.linalg.inv((x[:, 1:] - x[:, :1]).transpose(0, 2, 1))
    return np.concatenate([-last.sum(axis=1, keepdims=True), last], axis=1)


@dataclass(frozen=True, eq=False)
class TetMesh:
    """A mesh of linear tetrahedra with region labels and named point sets.

    Parameters
    ----------
    points : (n_points, 3) array
        Coordinates in mm, world axes RAS+.
    cells : (n_cells, 4) integer array
        Point indices; every cell has positive volume, (b−a)·((c−a)×(d−a)) > 0.
    region : (n_cells,) integer array
        Labels; `physgnn.geometry.regions` names them.
    point_sets : mapping of str to integer arrays
        Named sets of points, such as ``"fixed"`` and ``"loaded"``.

    Raises
    ------
    InputError
        If shapes, indices, coordinates or cell orientation are not as above, a point
        belongs to no cell (see `without_unused_points`), or two cells overlap at a
        face they share. Compiled code relies on all of this.
    """

    points: FloatArray
    cells: NDArray[np.int32]
    region: NDArray[np.int32]
    point_sets: Mapping[str, IntArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        points = checked_points(self.points, "points")
        cells = checked_indices(self.cells, len(points), "cells", corners=4)
        region = checked_labels(self.region, len(cells), "region")
        sets = {
            name: checked_indices(ids, len(points), f"point set '{name}'")
            for name, ids in self.point_sets.items()
        }
        check_corners(cells)
        cells32 = np.ascontiguousarray(cells, dtype=np.int32)
        for name, value in (
            ("points", points),
            ("cells", cells32),
            ("region", region),
            ("point_sets", sets),
        ):
            object.__setattr__(self, name, value)
        check_volumes(self.cell_volumes)
        check_used(points, cells32)
        check_faces(cells32)

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.points)

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return len(self.cells)

    @cached_property
    def cell_volumes(self) -> FloatArray:
        """Signed volume of every cell in mm³, shape (n_cells,)."""
        return signed_volumes(self.points, self.cells)

    @cached_property
    def content_hash(self) -> str:
        """SHA-256 of points, cells and region: the mesh a checkpoint belongs to."""
        digest = hashlib.sha256()
        for array in (self.points, self.cells, self.region):
            digest.update(str(array.shape).encode())
            digest.update(array.tobytes())
        return digest.hexdigest()

    def point_set(self, name: str) -> IntArray:
        """Return a named point set; InputError names the sets there are."""
        if name not in self.point_sets:
            have = ", ".join(sorted(self.point_sets)) or "none"
            raise InputError(
                f"the mesh has no point set '{name}' (it has: {have}): 'physgnn init' "
                "writes the sets of a craniotomy into a file, and 'physgnn mesh "
                "MESH.vtu --sets FILE' adds what a file names"
            )
        return self.point_sets[name]

    def with_point_sets(self, **point_sets: IntArray) -> "TetMesh":
        """Return the same mesh with these point sets added or replaced."""
        return replace(self, point_sets={**self.point_sets, **point_sets})


def signed_volumes(points: FloatArray, cells: NDArray[np.integer[Any]]) -> FloatArray:
    """Return (b−a)·((c−a)×(d−a)) / 6 of tetrahedra, mm³, (n_cells,).

    Parameters
    ----------
    points : (n_points, 3) array
        mm.
    cells : (n_cells, 4) integer array
        Point indices.
    """
    a, b, c, d = (points[cells[:, i]] for i in range(4))
    volumes: FloatArray = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6.0
    return volumes


def without_unused_points(
    points: FloatArray,
    cells: NDArray[np.integer[Any]],
    region: NDArray[np.int32],
    point_sets: Mapping[str, IntArray] | None = None,
) -> tuple[TetMesh, IntArray]:
    """Return a mesh of the points that cells have, and which of the points they were.

    Parameters
    ----------
    points, cells, region, point_sets
        As of a `TetMesh`, but points may belong to no cell. The sets lose them.

    Returns
    -------
    mesh : TetMesh
        Its points in the same order.
    used : (n_points of the mesh,) integer array
        The index each point had. A field on all points is ``field[used]`` on the mesh.

    Raises
    ------
    InputError
        If anything else is wrong with the mesh.
    """
    where = checked_points(points, "points")
    corners = checked_indices(cells, len(where), "cells", corners=4)
    used = np.unique(corners)
    index = np.full(len(where), -1, dtype=np.int64)
    index[used] = np.arange(len(used))
    sets = {
        name: index[checked_indices(ids, len(where), f"point set '{name}'")]
        for name, ids in (point_sets or {}).items()
    }
    mesh = TetMesh(
        where[used],
        index[corners].astype(np.int32),
        region,
        point_sets={name: ids[ids >= 0] for name, ids in sets.items()},
    )
    return mesh, used

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
        If shapes, indices, coordinates or cell orientation are not as above.
    """

    points: FloatArray
    cells: NDArray[np.int32]
    region: NDArray[np.int32]
    point_sets: Mapping[str, IntArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        points = np.ascontiguousarray(self.points, dtype=np.float64)
        cells = np.ascontiguousarray(self.cells, dtype=np.int32)
        region = np.ascontiguousarray(self.region, dtype=np.int32)
        sets = {
            name: np.asarray(ids, dtype=np.int64).ravel()
            for name, ids in self.point_sets.items()
        }
        for name, value in (
            ("points", points),
            ("cells", cells),
            ("region", region),
            ("point_sets", sets),
        ):
            object.__setattr__(self, name, value)
        self._check()

    def _check(self) -> None:
        n_points = self.n_points
        if self.points.ndim != 2 or self.points.shape[1] != 3 or n_points == 0:
            raise InputError(
                f"points must have shape (n_points, 3) (got {self.points.shape})"
            )
        if self.cells.ndim != 2 or self.cells.shape[1] != 4 or len(self.cells) == 0:
            raise InputError(
                f"cells must have shape (n_cells, 4) (got {self.cells.shape})"
            )
        if self.region.shape != (self.n_cells,):
            raise InputError(
                f"region must have one label a cell, ({self.n_cells},) "
                f"(got {self.region.shape})"
            )
        if not np.isfinite(self.points).all():
            bad = int(np.flatnonzero(~np.isfinite(self.points).all(axis=1))[0])
            raise InputError(f"points must be finite (point {bad} is not)")
        if self.cells.min() < 0 or self.cells.max() >= n_points:
            raise InputError(
                f"cells must index 0…{n_points - 1} "
                f"(got {self.cells.min()}…{self.cells.max()})"
            )
        if (self.cell_volumes <= 0).any():
            bad = int(np.flatnonzero(self.cell_volumes <= 0)[0])
            raise InputError(
                "cells must have positive volume "
                f"(cell {bad} has {self.cell_volumes[bad]:.3g} mm³); "
                "swap two of its points or remove it"
            )
        for name, ids in self.point_sets.items():
            if len(ids) and (ids.min() < 0 or ids.max() >= n_points):
                raise InputError(
                    f"point set '{name}' must index 0…{n_points - 1} "
                    f"(got {ids.min()}…{ids.max()})"
                )

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
                f"the mesh has no point set '{name}' (it has: {have}): name it by "
                "'physgnn mesh --sets'"
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

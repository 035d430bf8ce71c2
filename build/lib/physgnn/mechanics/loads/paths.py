"""Loads: one force field (load case) and the path that leads up to it."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.array_checks import checked_indices, checked_numbers
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.growth import VolumeGrowth
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.loads.pressure import SurfacePressure
from physgnn.mechanics.loads.springs import Springs

Load: TypeAlias = (
    SurfacePressure | Gravity | PrescribedDisplacement | Springs | VolumeGrowth
)


@dataclass(frozen=True, eq=False)
class LoadCase:
    """Dead nodal forces.

    Parameters
    ----------
    nodes : (n_loaded,) integer array
        Loaded points, each named once.
    forces : (n_loaded, 3) array
        Force on each, N, world axes.

    Raises
    ------
    InputError
        If shapes disagree, a node comes twice, a force is NaN, or all are zero
        (``allow_zero`` is not offered: without a load there is no displacement).
    """

    nodes: IntArray
    forces: FloatArray

    def __post_init__(self) -> None:
        nodes, forces = checked_forces(self.nodes, self.forces)
        object.__setattr__(self, "nodes", nodes)
        object.__setattr__(self, "forces", forces)

    def check_against(self, mesh: TetMesh, fixed: IntArray) -> None:
        """Raise InputError if a loaded node is missing from the mesh or fixed."""
        check_nodes(self.nodes, mesh, fixed)

    def on_points(self, n_points: int) -> FloatArray:
        """Return the force field, shape (n_points, 3), N."""
        field = np.zeros((n_points, 3))
        field[self.nodes] = self.forces
        return field


@dataclass(frozen=True, eq=False)
class LoadPath:
    """Loads that grow in proportion: ``forces × load_factor``.

    Parameters
    ----------
    nodes : (n_loaded,) integer array
        Loaded points, each named once; may be empty if there is `more`.
    forces : (n_loaded, 3) array
        Dead forces at load factor 1, N.
    load_factors : (n_levels,) array
        Strictly increasing, in (0, 1].
    more : tuple of Load
        Loads beside the nodal forces; they grow with the load factor too.

    Raises
    ------
    InputError
        If any of this does not hold.
    """

    nodes: IntArray
    forces: FloatArray
    load_factors: FloatArray
    more: tuple[Load, ...] = ()

    def __post_init__(self) -> None:
        more = tuple(self.more)
        if more and np.size(self.nodes) == np.size(self.forces) == 0:
            nodes, forces = np.empty(0, dtype=np.int64), np.empty((0, 3))
        else:
            nodes, forces = checked_forces(self.nodes, self.forces)
        object.__setattr__(self, "more", more)
        factors = checked_numbers(self.load_factors, "load_factors").ravel()
        if len(factors) == 0 or not np.isfinite(factors).all():
            raise InputError("load_factors must be one or more finite numbers")
        if factors[0] <= 0 or factors[-1] > 1 or (np.diff(factors) <= 0).any():
            raise InputError(
                "load_factors must increase strictly within (0, 1] "
                f"(got {factors[0]:g} … {factors[-1]:g})"
            )
        object.__setattr__(self, "nodes", nodes)
        object.__setattr__(self, "forces", forces)
        object.__setattr__(self, "load_factors", factors)

    @classmethod
    def of(cls, load_factors: FloatArray, *more: Load) -> "LoadPath":
        """Return a path of loads without nodal forces."""
        return cls(np.empty(0, dtype=np.int64), np.empty((0, 3)), load_factors, more)

    @property
    def n_levels(self) -> int:
        """Number of load levels."""
        return len(self.load_factors)

    def case(self, level: int) -> LoadCase:
        """Return the load case at a 0-based level.

        Raises
        ------
        InputError
            If there are loads that a load case cannot carry.
        """
        if self.more:
            raise InputError(
                "a load case is nodal forces alone; this path also has "
                + ", ".join(type(load).__name__ for load in self.more)
            )
        return LoadCase(self.nodes, self.forces * self.load_factors[level])

    def check_against(self, mesh: TetMesh, fixed: IntArray) -> None:
        """Raise InputError if a loaded node is missing from the mesh or fixed."""
        check_nodes(self.nodes, mesh, fixed)


def checked_forces(nodes: IntArray, forces: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return nodes and forces as arrays of the right shape, or raise InputError."""
    nodes = checked_indices(nodes, None, "nodes")
    forces = checked_numbers(forces, "forces")
    if len(nodes) == 0 or forces.shape != (len(nodes), 3):
        raise InputError(
            f"forces must have shape (n_loaded, 3) with n_loaded = {len(nodes)} ≥ 1 "
            f"(got {forces.shape})"
        )
    if not np.isfinite(forces).all():
        bad = int(nodes[~np.isfinite(forces).all(axis=1)][0])
        raise InputError(
            f"forces must be finite, in N (the force on node {bad} is not)"
        )
    if not forces.any():
        raise InputError("forces must not all be zero: there is nothing to solve")
    unique, counts = np.unique(nodes, return_counts=True)
    if (counts > 1).any():
        raise InputError(
            f"every loaded node must be named once (node {unique[counts > 1][0]} is "
            "repeated); add its forces up"
        )
    return nodes, forces


def check_nodes(nodes: IntArray, mesh: TetMesh, fixed: IntArray) -> None:
    """Raise InputError if a node is missing from the mesh or is fixed."""
    missing = nodes[(nodes < 0) | (nodes >= mesh.n_points)]
    if len(missing):
        raise InputError(
            f"loaded node {missing[0]} is not in the mesh (0…{mesh.n_points - 1})"
        )
    held = np.intersect1d(nodes, fixed)
    if len(held):
        raise InputError(
            f"loaded node {held[0]} is fixed ({len(held)} such): take it out of the "
            "load or out of the fixed set"
        )

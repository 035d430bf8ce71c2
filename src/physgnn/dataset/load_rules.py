"""Loads beside nodal forces, described so that they fit any mesh, and put on one.

A rule is a frozen dataclass with a method ``on``; `Gravity` needs none, it fits as it
is.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from physgnn.arrays import IntArray
from physgnn.dataset.size_bound import check_dataset_size
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_points
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.medical.markups import read_point_pairs
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.growth_rules import GrowthIn
from physgnn.mechanics.loads.paths import Load, LoadPath
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.loads.pressure import SurfacePressure, faces_within
from physgnn.mechanics.loads.sampling import FURTHER_SEED, equal_levels

Paths: TypeAlias = Callable[[TetMesh, IntArray], list[LoadPath]]
Further: TypeAlias = Callable[[TetMesh, IntArray, int], list[LoadPath]]
"""From mesh, loaded nodes and a number to so many further paths."""


def drawn_further(
    mesh: TetMesh,
    loaded: IntArray,
    n_paths: int,
    *,
    rule: Callable[..., list[LoadPath]],
    seed: int = 0,
) -> list[LoadPath]:
    """Return further paths of a rule with a seed: those of another seed.

    Parameters
    ----------
    mesh, loaded, n_paths
        As of `Further`.
    rule : callable
        Takes ``n_paths`` and ``seed`` by name.
    seed : int
        Of the paths there are already.
    """
    return rule(mesh, loaded, n_paths=n_paths, seed=seed + FURTHER_SEED)


@dataclass(frozen=True)
class PressureOn:
    """A pressure on the faces whose points are all in a point set.

    Attributes
    ----------
    points : str
        The point set.
    pressure_pa : float
        A positive pressure acts into the body.
    """

    points: str
    pressure_pa: float

    def on(self, mesh: TetMesh) -> SurfacePressure:
        """Return the load on a mesh; InputError if no face is in the set."""
        faces = faces_within(mesh, self.points)
        return SurfacePressure(faces.astype(np.int64), self.pressure_pa)


@dataclass(frozen=True)
class Shift:
    """A point set moved as one.

    Attributes
    ----------
    points : str
        The point set.
    vector_mm : (x, y, z)
        Where to, relative to its place at rest.
    """

    points: str
    vector_mm: tuple[float, float, float]

    def on(self, mesh: TetMesh) -> PrescribedDisplacement:
        """Return the load on a mesh."""
        nodes = mesh.point_set(self.points)
        return PrescribedDisplacement(nodes, np.tile(self.vector_mm, (len(nodes), 1)))


@dataclass(frozen=True)
class MeasuredPlaces:
    """Points of the surface pulled to where they were measured.

    Every measured point moves the surface point of the mesh nearest to it by as much;
    where several have the same nearest one, by their mean.

    Attributes
    ----------
    file : str
        Three points or more, where each was and where it went: a CSV, or markups of
        3D Slicer; see `physgnn.io.medical.markups`.
    snap_mm : float
        How far from a surface point of the mesh a measured point may lie.
    """

    file: str
    snap_mm: float = 10.0

    def on(self, mesh: TetMesh) -> PrescribedDisplacement:
        """Return the load on a mesh; InputError if a point is far from its surface."""
        from scipy.spatial import cKDTree

        pairs = read_point_pairs(self.file)
        surface = boundary_points(mesh)
        distance, nearest = cKDTree(mesh.points[surface]).query(pairs.source)
        far = int(distance.argmax())
        if distance[far] > self.snap_mm:
            raise InputError(
                f"{self.file}: point {pairs.source[far].tolist()} must lie within "
                f"{self.snap_mm:g} mm of a surface point of the mesh (the nearest is "
                f"{distance[far]:.1f} mm away): check axes and units"
            )
        nodes, index, count = np.unique(
            surface[nearest], return_inverse=True, return_counts=True
        )
        total = np.zeros((len(nodes), 3))
        np.add.at(total, index, pairs.displacement)
        return PrescribedDisplacement(nodes, total / count[:, None])


LoadRule: TypeAlias = PressureOn | Shift | MeasuredPlaces | GrowthIn | Gravity

MORE_LOADS: Mapping[str, type[LoadRule]] = {
    "pressure": PressureOn,
    "gravity": Gravity,
    "displacement": Shift,
    "measured": MeasuredPlaces,
    "growth": GrowthIn,
}
"""Each by the ``kind`` that a file names it by."""


def loads_on(mesh: TetMesh, rules: Sequence[LoadRule]) -> tuple[Load, ...]:
    """Put loads on a mesh; InputError if one does not fit it."""
    return tuple(r if isinstance(r, Gravity) else r.on(mesh) for r in rules)


def bounded(
    mesh: TetMesh, loaded: IntArray, *, paths: Paths, n_paths: int, n_levels: int
) -> list[LoadPath]:
    """Return load paths once their dataset is known to have a size that can be meant.

    Raises
    ------
    InputError
        If it is too large, see `physgnn.dataset.size_bound`.
    """
    check_dataset_size(n_paths, n_levels, mesh.n_points)
    return paths(mesh, loaded)


def with_more(
    mesh: TetMesh, loaded: IntArray, *, paths: Paths, more: Sequence[LoadRule]
) -> list[LoadPath]:
    """Return load paths that all have more loads beside their nodal forces."""
    loads = loads_on(mesh, more)
    return [replace(path, more=loads) for path in paths(mesh, loaded)]


def without_forces(
    mesh: TetMesh, _: IntArray, *, n_levels: int, more: Sequence[LoadRule]
) -> list[LoadPath]:
    """Return the one load path without nodal forces."""
    return [LoadPath.of(equal_levels(n_levels), *loads_on(mesh, more))]

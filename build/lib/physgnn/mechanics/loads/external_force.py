"""All loads of a path on one mesh: what pulls, what is put in place, what grows."""

from collections.abc import Callable

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.elements.growth import grown
from physgnn.mechanics.elements.tet4 import Elements, internal_force
from physgnn.mechanics.loads.growth import VolumeGrowth
from physgnn.mechanics.loads.paths import LoadPath, check_nodes
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.loads.springs import Springs


class Loading:
    """External force and prescribed places as functions of state and load factor.

    Parameters
    ----------
    mesh : TetMesh
    path : LoadPath
    fixed : integer array
        Fixed points.

    Attributes
    ----------
    held : integer array
        Points with prescribed displacement.
    stiffness : (n_points,) array
        Of springs to rest, N/mm: what they add to the tangent's diagonal.
    grows : bool
        Whether cells swell or contract.

    Raises
    ------
    InputError
        If a load names a point that is missing or fixed, or two loads claim one point.
    """

    def __init__(self, mesh: TetMesh, path: LoadPath, fixed: IntArray) -> None:
        prescribed = [m for m in path.more if isinstance(m, PrescribedDisplacement)]
        self.held = np.concatenate([np.empty(0, int), *(p.nodes for p in prescribed)])
        self._places = np.concatenate(
            [np.empty((0, 3)), *(p.displacement for p in prescribed)]
        )
        if len(np.unique(self.held)) < len(self.held):
            raise InputError("two prescribed displacements name the same point")
        for load in path.more:
            load.check_against(mesh)
        check_nodes(self.held, mesh, fixed)
        check_nodes(path.nodes, mesh, np.union1d(fixed, self.held))
        self._dead = np.zeros((mesh.n_points, 3))
        self._dead[path.nodes] = path.forces
        self.stiffness = np.zeros(mesh.n_points)
        self._growth = [m for m in path.more if isinstance(m, VolumeGrowth)]
        self.grows = bool(self._growth)
        self._grown: tuple[float, Elements, Elements] | None = None
        for load in path.more:
            if isinstance(load, Springs):
                self.stiffness[load.nodes] += load.stiffness_n_per_mm
        self._more: list[Callable[[FloatArray, float], FloatArray]] = [
            load.bind(mesh)
            for load in path.more
            if not isinstance(load, PrescribedDisplacement | VolumeGrowth)
        ]

    def force(self, u: FloatArray, load_factor: float) -> FloatArray:
        """External force on every point, (n_points, 3), N."""
        total = load_factor * self._dead
        for force in self._more:
            total += force(u, load_factor)
        return total

    def place(self, u: FloatArray, load_factor: float) -> None:
        """Put the held points where they belong."""
        u[self.held] = load_factor * self._places

    def elements(self, at_rest: Elements, load_factor: float) -> Elements:
        """Return the body's elements as they have grown; the very ones if none has."""
        if not self.grows:
            return at_rest
        if self._grown is None or self._grown[:2] != (load_factor, at_rest):
            ratio = np.ones(len(at_rest.cells))
            for growth in self._growth:
                growth.multiply(ratio, load_factor)
            self._grown = load_factor, at_rest, grown(at_rest, ratio)
        return self._grown[2]

    def growth_force(
        self, at_rest: Elements, u: FloatArray, load_factor: float
    ) -> FloatArray:
        """Return the force that growth adds at a state, (n_points, 3), N."""
        if not self.grows:
            return np.zeros_like(u)
        before, _ = internal_force(at_rest, u)
        after, _ = internal_force(self.elements(at_rest, load_factor), u)
        return before - after

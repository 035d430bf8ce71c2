"""The reduced model: nothing learnt, a few dozen unknowns, a few milliseconds.

A load is answered by the local expansion (`physgnn.mechanics.reduced.expansions.local`)
about known equilibria, solved exactly in the cells around the loaded points. Known are
the rest state and some of the training samples, the anchors, chosen to lie far from one
another. The solutions about the nearest anchors are averaged with weights
1 / distance⁴, so that an anchor's own load gets its own state back.
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import islice

import numpy as np
import torch
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.mesh_topology import points_within
from physgnn.learning.surrogate import Arrays, Surrogate
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.equilibrium.reference_states import (
    NearestReference,
    ReferenceState,
)
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.loads.paths import LoadCase, LoadPath
from physgnn.mechanics.reduced.expansions.load_distance import LoadDistance, farthest
from physgnn.mechanics.reduced.expansions.local import LocalExpansion
from physgnn.mechanics.reduced.expansions.recently_used import RecentlyUsed

MAX_BYTES = 2 * 2**30  # of the anchors' columns
FACTORS_AT_ONCE = 6  # of reference states, 80 MB each
LEAST_MM = 1e-9  # a distance can't be zero in a weight
FEW = 30  # loaded points; about more a prediction takes seconds

_About = tuple[int | None, tuple[int, ...]]  # an anchor, or rest, and nodes


class ReducedModel(Surrogate):
    """Local expansions about the rest state and some training samples.

    Expansions are made when first needed (half a second each on 9000 points) and kept,
    as many as ``PHYSGNN_CACHE_GB`` holds.

    Parameters
    ----------
    body : Body
        What it's made for; its elements are tet4.
    anchors : int
        How many training samples to expand about; fewer if so many points are loaded
        that they would take more than 2 GB.
    nearest_anchors : int
        The displacements about so many of the nearest anchors are averaged.
    k_hops : int
        Cells that lie whole in the k-hop neighbourhood of the loaded points, at most so
        many edges from one of them, are exact.
    k_hops_from_rest : int
        The same for loads on points that no anchor loads, which are answered about
        the rest state.

    Raises
    ------
    InputError
        If an option is out of range.
    """

    elements = (DEFAULT_ELEMENT,)
    zero_without_load = True

    def __init__(
        self,
        body: Body,
        *,
        anchors: int = 128,
        nearest_anchors: int = 3,
        k_hops: int = 1,
        k_hops_from_rest: int = 2,
    ) -> None:
        super().__init__(body)
        given = (anchors, k_hops, k_hops_from_rest, nearest_anchors)
        if min(given[:3]) < 0 or nearest_anchors < 1:
            raise InputError(
                "anchors, k_hops and k_hops_from_rest must be ≥ 0, nearest_anchors ≥ 1 "
                f"(got {', '.join(map(str, given))})"
            )
        self.nearest_anchors, self.k_hops = nearest_anchors, k_hops
        self.k_hops_from_rest = k_hops_from_rest
        threads = torch.get_num_threads()
        self._linear = make_linear_solver(body.pattern, threads=threads)
        shape = (anchors, body.mesh.n_points, 3)
        self.states = np.zeros(shape, dtype=np.float32)
        self.loads = np.zeros(shape, dtype=np.float32)
        self._known: _ReferenceLoads | None = None
        # One about 17 points takes 6 MB on 9000, one about hundreds a hundred.
        self._kept: RecentlyUsed[_About, LocalExpansion] = RecentlyUsed(
            self._expansion, lambda expansion: expansion.n_bytes
        )
        self._state = lru_cache(FACTORS_AT_ONCE)(self._reference_state)

    def fit(self, store: Store, samples: IntArray, seed: int = 0) -> None:
        """Choose the anchors: each time the sample farthest from those chosen."""
        del seed
        self.states = np.zeros_like(self.states)
        self.loads = np.zeros_like(self.loads)
        for i, (path, level) in enumerate(self._far_apart(store, samples).tolist()):
            case = store.load_case(path, level)
            self.loads[i] = case.on_points(self.body.mesh.n_points)
            self.states[i] = store.displacement(path)[level]
        self.forget()

    def _far_apart(self, store: Store, samples: IntArray) -> IntArray:
        numbers, path = np.unique(samples[:, 0], return_inverse=True)
        paths = [store.load_path(int(number)) for number in numbers]
        nodes = np.unique(np.concatenate([each.nodes for each in paths]))
        distance = LoadDistance(self.body, nodes)
        forces = np.zeros((len(paths), len(distance.nodes), 3))
        for each, force in zip(paths, forces, strict=True):
            free = np.isin(each.nodes, distance.nodes)
            at = np.searchsorted(distance.nodes, each.nodes[free])
            force[at] = each.forces[free]
        # Coordinates are linear in the force: a level is a factor.
        factor = store.load_factors[samples[:, 1], None]
        coordinates = factor * distance.coordinates(forces)[path]
        return samples[farthest(coordinates, self._affordable(paths))]

    def _affordable(self, paths: Sequence[LoadPath]) -> int:
        """Return how many anchors' columns fit into memory, at least one."""
        mesh = self.body.mesh
        near = (points_within(mesh, path.nodes, self.k_hops) for path in paths)
        widest = max(int(points.sum()) for points in near)
        n_bytes = 4 * 3 * widest * 3 * mesh.n_points
        return min(len(self.states), max(MAX_BYTES // n_bytes, 1))

    def forget(self) -> None:
        """Drop what was made from the anchors; it's made again when needed."""
        self._known = None
        self._kept.clear()
        self._state.cache_clear()

    def predict(self, load_case: LoadCase) -> FloatArray:
        """Return the mean of the nearest expansions, (n_points, 3), mm."""
        force = load_case.on_points(self.body.mesh.n_points)
        found = list(islice(self._converged(force), self.nearest_anchors))
        if not found:
            nodes = tuple(np.flatnonzero(force.any(axis=1)).tolist())
            return self._kept((None, nodes))(force).displacement
        weights = np.array([weight for weight, _ in found])
        expansions = np.stack([u for _, u in found])
        mean: FloatArray = np.tensordot(weights / weights.sum(), expansions, axes=1)
        return mean

    def is_sound(self, load_case: LoadCase) -> bool:
        """Return whether the cells near the loads are in equilibrium."""
        force = load_case.on_points(self.body.mesh.n_points)
        return next(self._converged(force), None) is not None

    def reference_states(self) -> NearestReference:
        """Return how to find the nearest anchor."""
        return self.nearest_reference

    def arrays(self) -> Arrays:
        """Return the anchors' displacements, mm, and their loads, N."""
        return {"states": self.states, "loads": self.loads}

    def restore(self, arrays: Arrays) -> None:
        """Take the anchors."""
        self.states, self.loads = arrays["states"], arrays["loads"]
        self.forget()

    @classmethod
    def is_meant_for(cls, store: Store, test: IntArray) -> bool:
        """Return whether all tested loads act on few points."""
        paths = np.unique(test[:, 0]).tolist()
        return max(len(store.load_path(path).nodes) for path in paths) <= FEW

    def nearest_reference(self, force: FloatArray) -> ReferenceState:
        """Return the nearest anchor that loads every point a force loads, or rest."""
        k, _, _ = next(self._nearest(force))
        return self._state(k)

    def _converged(self, force: FloatArray) -> Iterator[tuple[float, FloatArray]]:
        """Yield weights and solutions about anchors, the nearest first."""
        for k, distance, nodes in self._nearest(force):
            solution = self._kept((k, nodes))(force)
            if solution.converged:
                yield max(distance, LEAST_MM) ** -4.0, solution.displacement

    def _nearest(
        self, force: FloatArray
    ) -> Iterator[tuple[int | None, float, tuple[int, ...]]]:
        if self._known is None:
            self._known = _ReferenceLoads(self.body, self.loads)
        return self._known.nearest(force)

    def _reference_state(self, k: int | None) -> ReferenceState:
        return ReferenceState.of(self.body, self._displacement(k))

    def _displacement(self, k: int | None) -> FloatArray:
        """Return an anchor's displacement, or that of the rest state."""
        if k is None:
            return np.zeros_like(self.body.mesh.points)
        state: FloatArray = self.states[k].astype(np.float64)
        return state

    def _expansion(self, about: _About) -> LocalExpansion:
        """Expand about an anchor, or the rest state, exact around some nodes."""
        k, nodes = about
        hops = self.k_hops_from_rest if k is None else self.k_hops
        loaded = np.array(nodes, dtype=np.int64)
        near = points_within(self.body.mesh, loaded, hops)
        return LocalExpansion(
            self.body, self._displacement(k), np.flatnonzero(near), self._linear
        )


class _ReferenceLoads:
    """The anchors' loads, and which are near a given one."""

    def __init__(self, body: Body, loads: NDArray[np.float32]) -> None:
        loaded = (loads != 0.0).any(axis=2)
        self._used = np.flatnonzero(loaded.any(axis=1))
        self._nodes = [np.flatnonzero(loaded[k]) for k in self._used]
        self._distance = LoadDistance(body, np.flatnonzero(loaded.any(axis=0)))
        fields = loads[self._used][:, self._distance.nodes].astype(np.float64)
        self._coordinates = self._distance.coordinates(fields)

    def nearest(
        self, force: FloatArray
    ) -> Iterator[tuple[int | None, float, tuple[int, ...]]]:
        """Yield anchors that load every point a force loads: index, distance, points.

        The nearest come first; the rest state, None, is among them.
        """
        asked = np.flatnonzero(force.any(axis=1))
        f = self._distance.coordinates(force[None, self._distance.nodes])
        away = np.linalg.norm(self._coordinates - f, axis=1)
        near: list[tuple[float, int | None, tuple[int, ...]]] = [
            (float(np.linalg.norm(f)), None, tuple(asked.tolist()))
        ]
        near += [
            (float(away[i]), int(self._used[i]), tuple(self._nodes[i].tolist()))
            for i in np.flatnonzero([np.isin(asked, at).all() for at in self._nodes])
        ]
        for distance, k, nodes in sorted(near, key=lambda known: known[0]):
            yield k, distance, nodes

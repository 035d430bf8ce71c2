"""A prediction improved where it is most out of balance, a patch at a time.

What a network leaves of the error is largest in a few places under the load. There a
patch, the points within two edges of one, takes one step of Newton's method, all other
points staying where they are: a multiplicative Schwarz method (Smith, Bjørstad & Gropp
1996, *Domain Decomposition*, chapter 1) that visits the worst patches alone. With
D the points' own 3 × 3 blocks of the stiffness at rest, |D⁻¹ (f − f_int(u))| tells
which they are: how far a point would go by itself.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import sposv

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.patch import grow, newton_system
from physgnn.mechanics.elements.subset import some_cells
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT, energy_of
from physgnn.mechanics.linear.blas_threads import one_blas_thread
from physgnn.mechanics.reduced.submodels.force_left import ForceLeft

K_HOPS = 2  # of a patch: one hop does half as much, three take ten times as long
MOST_POINTS = 200  # of a patch, whose matrix is dense; a larger one shrinks to one hop
LEAST_MM = 0.01  # a point that would go less far is left where it is
HALVINGS = 3  # of a step that raises the energy; then it is not taken


class PatchRelaxation:
    """Relaxes the worst patches near loads.

    Parameters
    ----------
    body : Body
        Of linear tetrahedra that are not averaged.
    near : (n_points,) boolean array
        Where patches may have their centre.
    n_patches : int
        How many to relax at most.

    Raises
    ------
    InputError
        If the body's elements are averaged.
    """

    def __init__(self, body: Body, near: BoolArray, n_patches: int) -> None:
        if body.element != DEFAULT_ELEMENT:
            raise InputError(
                f"patches are of {DEFAULT_ELEMENT} elements (got {body.element})"
            )
        elements = body.elements
        self._elements, self._n_patches = elements, n_patches
        self._arrays = (
            elements.cells, elements.gradients, elements.rest, elements.volumes,
            elements.law, elements.constants,
        )  # fmt: skip
        n = elements.n_points
        self._free = np.ones(n, dtype=np.bool_)
        self._free[body.fixed] = False
        self._left = ForceLeft(body, near)
        around = np.asarray(near[elements.cells].any(axis=1), dtype=np.bool_)
        blocks = _blocks_at_rest(body, around)[self._left.points]
        self._inverses = np.linalg.inv(blocks)
        corners = elements.cells.ravel()
        self._cells_of = (np.argsort(corners, kind="stable") // 4).astype(np.int32)
        counts = np.bincount(corners, minlength=n)
        self._first_cell = np.concatenate([[0], np.cumsum(counts)])

    def __call__(self, force: FloatArray, displacement: FloatArray) -> FloatArray:
        """Return a prediction with its worst patches relaxed, (n_points, 3) mm.

        Parameters
        ----------
        force : (n_points, 3) array
            The load, N.
        displacement : (n_points, 3) array
            The prediction, mm; a patch in which it inverts a cell is left as it is.
        """
        u = displacement.copy()
        with one_blas_thread():
            for centre in self._worst(force, u):
                for k_hops in range(K_HOPS, 0, -1):
                    patch = self._patch(centre, k_hops)
                    if len(patch.points) <= MOST_POINTS:
                        self._step(patch, force, u)
                        break
        return u

    def _worst(self, force: FloatArray, u: FloatArray) -> list[int]:
        """Return centres that are no neighbours, the worst one first."""
        left = self._left.at_points(force, u)
        alone = np.einsum("nij,nj->ni", self._inverses, left)
        length = np.zeros(len(u))
        length[self._left.points] = np.sqrt(np.einsum("ni,ni->n", alone, alone))
        found: list[int] = []
        while len(found) < self._n_patches:
            worst = int(length.argmax())
            if not length[worst] > LEAST_MM:
                break
            found.append(worst)
            cells = self._cells_of[
                self._first_cell[worst] : self._first_cell[worst + 1]
            ]
            length[self._elements.cells[cells]] = 0.0
        return found

    def _patch(self, centre: int, k_hops: int) -> "_Patch":
        cells, n = self._elements.cells, self._elements.n_points
        place = np.full(n, -1, dtype=np.int32)
        points, touched = np.empty(n, np.int32), np.empty(len(cells), np.int32)
        seen = np.zeros(len(cells), dtype=np.bool_)
        around = self._first_cell, self._cells_of, self._free
        n_points, n_touched = grow(
            centre, k_hops, cells, *around, place, points, touched, seen
        )
        return _Patch(points[:n_points], touched[:n_touched], place)

    def _step(self, patch: "_Patch", force: FloatArray, u: FloatArray) -> None:
        """Take Newton's step in place, if it lowers the energy."""
        points, touched, arrays = patch.points, patch.touched, self._arrays
        load, n = force[points], 3 * len(points)
        K, inner = np.zeros((n, n), dtype=np.float32), np.zeros(n)
        before = newton_system(touched, *arrays, u, patch.place, K, inner)
        if not np.isfinite(before):
            return
        _, found, failed = sposv(K.T, load.ravel() - inner, overwrite_a=True)
        if failed or not np.isfinite(found).all():
            return
        step, start = found.reshape(-1, 3).astype(np.float64), u[points]
        for _ in range(HALVINGS + 1):
            u[points] = start + step
            if energy_of(touched, *arrays, u) - float((load * step).sum()) <= before:
                return
            step /= 2
        u[points] = start


@dataclass(frozen=True, eq=False)
class _Patch:
    """Some points, all cells they touch, and where each point is among them, or −1."""

    points: NDArray[np.int32]
    touched: NDArray[np.int32]
    place: NDArray[np.int32]


def _blocks_at_rest(body: Body, chosen: BoolArray) -> FloatArray:
    """Return the points' own blocks of the stiffness at rest, (n_points, 3, 3), N/mm.

    At rest every law is linear elasticity: Σ V (μ |∇N|² I + (λ + μ) ∇N ∇Nᵀ).
    """
    elements = some_cells(body.elements, chosen)
    mu, lam = np.zeros((2, len(elements.volumes)))
    for label, material in body.materials.items():
        inside = body.mesh.region[chosen] == label
        mu[inside] = material.mu * elements.volumes[inside]
        lam[inside] = material.lam * elements.volumes[inside]
    blocks = np.zeros((elements.n_points, 3, 3))
    for a in range(4):
        g = elements.gradients[:, a]
        square = np.einsum("ei,ei->e", g, g)
        of_corner = (mu * square)[:, None, None] * np.eye(3)
        of_corner += (lam + mu)[:, None, None] * np.einsum("ei,ej->eij", g, g)
        np.add.at(blocks, elements.cells[:, a], of_corner)
    return blocks

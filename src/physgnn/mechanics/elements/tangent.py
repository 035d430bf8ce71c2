"""The tangent matrix: its pattern once a mesh, its values at every state."""

from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.elements.averaged_pressure import (
    Averaging,
    pressure_rows,
    volume_gradients,
)
from physgnn.mechanics.elements.cell_kinematics import kinematics
from physgnn.mechanics.elements.cell_tangent import cell_stiffness, contracted
from physgnn.mechanics.elements.convexity import make_convex
from physgnn.mechanics.elements.tet4 import (
    NO_PRESSURE,
    Elements,
    MeanState,
    check_state,
    mean_state,
)
from physgnn.mechanics.materials import table

Real = TypeVar("Real", bound=np.floating[Any])


@dataclass(frozen=True, eq=False)
class Pattern:
    """Upper triangle of the tangent over the free points, in CSR.

    Averaged elements have a row for the pressure of every group after those of the
    unknowns (`physgnn.mechanics.elements.averaged_pressure`).

    Attributes
    ----------
    free : (n_free,) array
        Points that move; unknown 3 i + r is component r of point free[i].
    indptr, indices : int32 arrays
        CSR structure of the upper triangle, diagonal included.
    slot : (n_cells, 4, 4) int32 array
        For the block of corners a, b: its rank among the blocks of its row, or −1
        where the block is fixed or belongs to the transposed half.
    row : (n_points,) int32 array
        Rank of a point among the free ones, or −1.
    group_slot : (n_places,) int32 array
        For every point of every group of averaged elements: how far before the end of
        the point's rows the group's entry is, or 0 where the point is fixed.
    """

    free: IntArray
    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    slot: NDArray[np.int32]
    row: NDArray[np.int32]
    group_slot: NDArray[np.int32]

    @property
    def n_unknowns(self) -> int:
        """Number of free degrees of freedom; rows after these are of pressures."""
        return 3 * len(self.free)

    def unknowns(self, fields: NDArray[Real]) -> NDArray[Real]:
        """Return the free components (…, n_unknowns) of fields (…, n_points, 3)."""
        return fields[..., self.free, :].reshape(*fields.shape[:-2], self.n_unknowns)

    def add_to_diagonal(self, values: FloatArray, per_point: FloatArray) -> None:
        """Add a stiffness of every point, (n_points,), to a tangent's values in place.

        The diagonal comes first in every row of the upper triangle.
        """
        diagonal = self.indptr[: self.n_unknowns]
        values[diagonal] += np.repeat(per_point[self.free], 3)

    def on_points(self, unknowns: NDArray[Real]) -> NDArray[Real]:
        """Return fields (…, n_points, 3) of unknowns (…, n_unknowns); zero if held."""
        shape = (*unknowns.shape[:-1], len(self.row), 3)
        fields = np.zeros(shape, dtype=unknowns.dtype)
        fields[..., self.free, :] = unknowns.reshape(*unknowns.shape[:-1], -1, 3)
        return fields


def make_pattern(
    cells: NDArray[np.int32],
    n_points: int,
    fixed: IntArray,
    averaging: Averaging | None = None,
) -> Pattern:
    """Find the pattern of the tangent with the fixed points left out."""
    free = np.setdiff1d(np.arange(n_points), fixed)
    row = np.full(n_points, -1, dtype=np.int32)
    row[free] = np.arange(len(free), dtype=np.int32)
    a, b = np.repeat(np.arange(4), 4), np.tile(np.arange(4), 4)
    first, second = row[cells[:, a]].ravel(), row[cells[:, b]].ravel()
    block_indptr, block_indices, slot = _rank_blocks(first, second, len(free))
    groups = _rank_groups(averaging, row, len(free))
    indptr, indices = _expand_blocks(block_indptr, block_indices, *groups[:3])
    return Pattern(free, indptr, indices, slot.reshape(-1, 4, 4), row, groups[3])


def _rank_blocks(
    first: NDArray[np.int32], second: NDArray[np.int32], n_free: int
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
    """Return the upper blocks in CSR, and every pair's rank in its row, or −1."""
    used = (first >= 0) & (second >= first)
    key = first[used].astype(np.int64) * n_free + second[used]
    blocks, place = np.unique(key, return_inverse=True)
    row, column = np.divmod(blocks, n_free)
    indptr = np.searchsorted(row, np.arange(n_free + 1)).astype(np.int32)
    rank = np.full(len(first), -1, dtype=np.int32)
    rank[used] = place - indptr[first[used]]
    return indptr, column.astype(np.int32), rank


def _rank_groups(
    averaging: Averaging | None, row: NDArray[np.int32], n_free: int
) -> tuple[NDArray[np.int32], NDArray[np.int32], int, NDArray[np.int32]]:
    """Return the groups of every free point in CSR, their number, and `group_slot`."""
    if averaging is None:
        none = np.zeros(0, dtype=np.int32)
        return np.zeros(n_free + 1, dtype=np.int32), none, 0, none
    n_groups = len(averaging.volumes)
    group = np.repeat(np.arange(n_groups), np.diff(averaging.start))
    of_point = row[averaging.points]
    places = np.flatnonzero(of_point >= 0)
    places = places[np.lexsort((group[places], of_point[places]))]
    indptr = np.searchsorted(of_point[places], np.arange(n_free + 1))
    slot = np.zeros(len(group), dtype=np.int32)
    slot[places] = indptr[of_point[places] + 1] - np.arange(len(places))
    return indptr.astype(np.int32), group[places].astype(np.int32), n_groups, slot


@njit(cache=True)
def _expand_blocks(block_indptr, block_indices, group_indptr, groups, n_groups):  # type: ignore[no-untyped-def]
    """Turn 3×3 blocks and the pressures beside them into a CSR of upper entries."""
    n = len(block_indptr) - 1
    indptr = np.zeros(3 * n + n_groups + 1, dtype=np.int32)
    for i in range(n):
        length = 3 * (block_indptr[i + 1] - block_indptr[i])
        length += group_indptr[i + 1] - group_indptr[i]
        for r in range(3):
            indptr[3 * i + r + 1] = indptr[3 * i + r] + length - r
    for g in range(n_groups):
        indptr[3 * n + g + 1] = indptr[3 * n + g] + 1
    indices = np.empty(indptr[-1], dtype=np.int32)
    for i in range(n):
        for r in range(3):
            at = indptr[3 * i + r]
            for k in range(block_indptr[i], block_indptr[i + 1]):
                first = r if k == block_indptr[i] else 0
                for c in range(first, 3):
                    indices[at] = 3 * block_indices[k] + c
                    at += 1
            for k in range(group_indptr[i], group_indptr[i + 1]):
                indices[at] = 3 * n + groups[k]
                at += 1
    for g in range(n_groups):
        indices[indptr[3 * n + g]] = 3 * n + g
    return indptr, indices


@njit(cache=True)
def _add_pressure_tangent(pJ, H, A):  # type: ignore[no-untyped-def]
    """Add p ∂²J/∂F² = p J (H_iJ H_kL − H_iL H_kJ)."""
    for i in range(3):
        for j in range(3):
            for k in range(3):
                for m in range(3):
                    A[i, j, k, m] += pJ * (H[i, j] * H[k, m] - H[i, m] * H[k, j])


@njit(cache=True)
def _assemble(  # type: ignore[no-untyped-def]
    chosen, cells, gradients, rest, volumes, law, constants, pressure, u,
    row, slot, indptr, data, convex,
):  # fmt: skip
    F, H = np.empty((3, 3)), np.empty((3, 3))
    A, Ag = np.empty((3, 3, 3, 3)), np.empty((3, 3, 3))
    K, room = np.empty((4, 4, 3, 3)), (A, Ag, np.empty((4, 3)))
    for e in chosen:
        J = kinematics(cells[e], gradients[e], rest[e], u, F, H)
        if not J > 0.0:
            return e
        if convex or len(pressure):
            table.tangent(law[e], F, H, J, constants[e], A)
            if len(pressure):
                _add_pressure_tangent(pressure[e] * J, H, A)
            if convex:
                make_convex(A)
            contracted(gradients[e], volumes[e], A, Ag, K)
        else:
            cell_stiffness(
                law[e], F, H, J, constants[e], gradients[e], volumes[e], room, K
            )
        for a in range(4):
            for b in range(4):
                rank = slot[e, a, b]
                if rank < 0:
                    continue
                i = row[cells[e, a]]
                for r in range(3):
                    # Row r of the diagonal block starts at its diagonal entry, so
                    # everything in that row sits r places further left.
                    at = indptr[3 * i + r] + 3 * rank - r
                    for c in range(r if a == b else 0, 3):
                        data[at + c] += K[a, b, r, c] if a <= b else K[b, a, c, r]
    return -1


def assemble_tangent(
    elements: Elements,
    pattern: Pattern,
    u: FloatArray,
    *,
    cells: IntArray | None = None,
    convex: bool = False,
) -> tuple[FloatArray, int]:
    """Values of K(u) in the pattern's CSR order.

    Parameters
    ----------
    elements : Elements
    pattern : Pattern
    u : (n_points, 3) array
        mm.
    cells : integer array, optional
        The cells that are added up, all by default. Changes of volume are averaged
        over all in any case.
    convex : bool
        Leave out what makes a cell unstable (`physgnn.mechanics.elements.convexity`).

    Returns
    -------
    data : (nnz,) array
        N/mm.
    inverted : int
        First cell with det F ≤ 0, or −1; the values are then of no use.
    """
    check_state(elements, u)
    data = np.zeros(len(pattern.indices))
    pressure = NO_PRESSURE
    if elements.averaging is not None:
        state, inverted = mean_state(elements, u)
        if state is None:
            return data, inverted
        pressure = state.pressure
        _assemble_groups(elements, pattern, state, data)
    inverted = _assemble(
        np.arange(len(elements.cells)) if cells is None else cells,
        elements.cells,
        elements.gradients,
        elements.rest,
        elements.volumes,
        elements.law,
        elements.constants,
        pressure,
        u,
        pattern.row,
        pattern.slot,
        pattern.indptr,
        data,
        convex,
    )
    return data, int(inverted)


def _assemble_groups(
    elements: Elements, pattern: Pattern, state: MeanState, data: FloatArray
) -> None:
    """Fill in the rows and columns of the pressures."""
    averaging = elements.averaging
    assert averaging is not None
    B = volume_gradients(
        state.cofactors,
        elements.volumes,
        elements.gradients,
        averaging.groups,
        averaging.volumes,
        averaging.place,
        len(averaging.points),
    )
    coupling, diagonal = pressure_rows(averaging, state.mean, B)
    row = pattern.row[averaging.points]
    moving = row >= 0
    for r in range(3):
        end = pattern.indptr[3 * row[moving] + r + 1]
        data[end - pattern.group_slot[moving]] = coupling[moving, r]
    data[pattern.indptr[pattern.n_unknowns : -1]] = diagonal

"""Exactly nonlinear near the loads, linear about a known state everywhere else.

A force on a few points strains a few cells beyond anything linear, and the rest of the
body little. With g(u) what the internal force of the cells near the loads departs from
its linearisation about a state ū, and K = K(ū), f̄ = f_int(ū),

    u = ū + K⁻¹ (f − f̄ − g(u)).

f and g live on the patch D, the points of those cells: K⁻¹ is needed only in D's
columns, and the unknown is u on D. Written with the stiffness S of all other cells as D
feels it, S = (K⁻¹ on D)⁻¹ − K of the patch's own cells, the equation is the equilibrium
of a small body on springs,

    f_int,D(u) + S (u − ū) = f − f̄ + f_int,D(ū),

the minimum of an energy, found by Newton's method with a line search along which no
cell inverts.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from physgnn.mechanics.assembly import Pattern, assemble_tangent, make_pattern
from physgnn.mechanics.dense_newton import minimise
from physgnn.mechanics.element import Elements, internal_force, strain_energy
from physgnn.mechanics.linear_solver import LinearSolver

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

COLUMNS_AT_ONCE = 32


@dataclass(frozen=True, eq=False)
class LocalAnswer:
    """What a local expansion found.

    Attributes
    ----------
    displacement : (n_points, 3) array
        mm.
    converged : bool
        Whether the patch is in equilibrium; if not, this is the lowest energy reached.
    steps : int
        Newton steps taken.
    """

    displacement: FloatArray
    converged: bool
    steps: int


class LocalExpansion:
    """Answers forces on a patch of points, about one state.

    Parameters
    ----------
    elements : Elements
        Of linear tetrahedra that are not averaged.
    pattern : Pattern
        Of the whole body, made by `make_pattern`.
    state : (n_points, 3) array
        ū, mm. It needn't be in equilibrium, but stable.
    points : integer array
        The patch; forces act only here. Cells with all their points in it are
        nonlinear.
    linear : LinearSolver
        Of the pattern, in double precision; used while this is made, and no more.

    Raises
    ------
    ValueError
        If K(ū) is not positive definite.
    """

    def __init__(
        self,
        elements: Elements,
        pattern: Pattern,
        state: FloatArray,
        points: IntArray,
        linear: LinearSolver,
    ) -> None:
        data, inverted = assemble_tangent(elements, pattern, state)
        if inverted >= 0 or not linear.factorize(data):
            raise ValueError("the state to expand about is not stable")
        self._free, self._shape = pattern.free, state.shape
        part, moving, self._dofs = _cut_out(elements, pattern, points)
        self._columns, G = _columns(linear, self._dofs, pattern.n_unknowns)
        self._state = state[pattern.free].ravel()
        self._load = internal_force(elements, state)[0][pattern.free].ravel()
        # What holds ū beside the patch is no part of the load: it is let go.
        elsewhere = self._load.copy()
        elsewhere[self._dofs] = 0.0
        self._let_go = -linear.solve(elsewhere)
        self._start = self._state[self._dofs]
        stiffness = np.linalg.inv((G + G.T) / 2).astype(np.float64)
        self._patch = _Patch.on_springs(part, moving, self._start, stiffness)
        self._balance = self._patch.force(self._start) - self._load[self._dofs]
        self._balance += self._patch.stable @ self._let_go[self._dofs]

    def __call__(self, force: FloatArray) -> LocalAnswer:
        """Return the answer to a force field (n_points, 3) in N, zero beside D."""
        f = force[self._free].ravel()[self._dofs]
        found = minimise(self._patch, f + self._balance, self._start)
        moved = found.x - self._start - self._let_go[self._dofs]
        push = (self._patch.stable @ moved).astype(np.float32)
        u = np.zeros(self._shape)
        u[self._free] = (self._state + self._let_go + push @ self._columns).reshape(
            -1, 3
        )
        return LocalAnswer(u, found.converged, found.steps)


@dataclass(frozen=True, eq=False)
class _Patch:
    """A part of a body, held by springs S that stand for the rest of it.

    `moving` are its points that aren't fixed, `pattern` leaves out those without cells
    of their own too; `stable` is the stiffness of all at the state S was made for.
    """

    elements: Elements
    moving: IntArray
    pattern: Pattern
    springs: FloatArray
    stable: FloatArray

    @classmethod
    def on_springs(
        cls, elements: Elements, moving: IntArray, x: FloatArray, stiffness: FloatArray
    ) -> "_Patch":
        """Make the springs such that the stiffness of the whole at x is as given."""
        everywhere = np.arange(elements.n_points)
        unknown = np.intersect1d(moving, elements.cells)
        pattern = make_pattern(
            elements.cells, elements.n_points, np.setdiff1d(everywhere, unknown)
        )
        loose = cls(elements, moving, pattern, np.zeros_like(stiffness), stiffness)
        return replace(loose, springs=stiffness - loose.stiffness(x))

    def energy(self, x: FloatArray) -> float:
        own = strain_energy(self.elements, self._displacement(x))
        return own + 0.5 * float(x @ self.springs @ x)

    def force(self, x: FloatArray) -> FloatArray:
        own, _ = internal_force(self.elements, self._displacement(x))
        total: FloatArray = own[self.moving].ravel() + self.springs @ x
        return total

    def stiffness(self, x: FloatArray) -> FloatArray:
        own, _ = assemble_tangent(self.elements, self.pattern, self._displacement(x))
        at = np.searchsorted(self.moving, self.pattern.free)
        at = (3 * at[:, None] + np.arange(3)).ravel()
        row, column = at.repeat(np.diff(self.pattern.indptr)), at[self.pattern.indices]
        K = self.springs.copy()
        K[row, column] += own
        off_diagonal = row != column
        K[column[off_diagonal], row[off_diagonal]] += own[off_diagonal]
        return K

    def _displacement(self, x: FloatArray) -> FloatArray:
        u = np.zeros((self.elements.n_points, 3))
        u[self.moving] = x.reshape(-1, 3)
        return u


def _cut_out(
    elements: Elements, pattern: Pattern, points: IntArray
) -> tuple[Elements, IntArray, IntArray]:
    """Return the cells among some points, which of these move, and their unknowns."""
    points = np.unique(points)
    place = np.full(elements.n_points, -1, dtype=np.int32)
    place[points] = np.arange(len(points), dtype=np.int32)
    inside = (place[elements.cells] >= 0).all(axis=1)
    part = replace(
        elements,
        cells=np.ascontiguousarray(place[elements.cells[inside]]),
        gradients=elements.gradients[inside],
        volumes=elements.volumes[inside],
        law=elements.law[inside],
        constants=elements.constants[inside],
        n_points=len(points),
    )
    rows = pattern.row[points]
    dofs = (3 * rows[rows >= 0, None].astype(np.int64) + np.arange(3)).ravel()
    return part, np.flatnonzero(rows >= 0), dofs


def _columns(
    linear: LinearSolver, dofs: IntArray, n_unknowns: int
) -> tuple[NDArray[np.float32], FloatArray]:
    """Return some columns of K⁻¹, as rows, and in double their part at the same."""
    columns = np.empty((len(dofs), n_unknowns), dtype=np.float32)
    G = np.empty((len(dofs), len(dofs)))
    for first in range(0, len(dofs), COLUMNS_AT_ONCE):
        some = dofs[first : first + COLUMNS_AT_ONCE]
        unit = np.zeros((len(some), n_unknowns))
        unit[np.arange(len(some)), some] = 1.0
        answer = linear.solve(unit)
        columns[first : first + len(some)] = answer
        G[first : first + len(some)] = answer[:, dofs]
    return columns, G

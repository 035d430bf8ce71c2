"""Exactly nonlinear near the loads, linear about a reference state everywhere else.

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

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.linear.protocols import LinearSolver
from physgnn.mechanics.reduced.energy_minimiser import minimise
from physgnn.mechanics.reduced.submodels.submesh import CondensedCells, cut_out

COLUMNS_AT_ONCE = 32


@dataclass(frozen=True, eq=False)
class LocalSolution:
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
    """Solves for forces on a patch of points, about one state.

    Parameters
    ----------
    body : Body
        Of linear tetrahedra that are not averaged.
    state : (n_points, 3) array
        ū, mm. It needn't be in equilibrium, but stable.
    points : integer array
        The patch; forces act only here. Cells with all their points in it are
        nonlinear.
    linear : LinearSolver
        Of the body's pattern, in double precision; used while this is made, and no
        more.

    Raises
    ------
    ValueError
        If K(ū) is not positive definite.
    """

    def __init__(
        self,
        body: Body,
        state: FloatArray,
        points: IntArray,
        linear: LinearSolver,
    ) -> None:
        elements, pattern = body.elements, body.pattern
        data, inverted = assemble_tangent(elements, pattern, state)
        if inverted >= 0 or not linear.factorize(data):
            raise ValueError("the state to expand about is not stable")
        self._pattern = pattern
        part, moving, self._dofs = cut_out(elements, pattern, points)
        self._columns, G = _columns(linear, self._dofs, pattern.n_unknowns)
        self._state = pattern.unknowns(state)
        self._load = pattern.unknowns(internal_force(elements, state)[0])
        # What holds ū beside the patch is no part of the load: it is let go.
        elsewhere = self._load.copy()
        elsewhere[self._dofs] = 0.0
        self._let_go = -linear.solve(elsewhere)
        self._start = self._state[self._dofs]
        stiffness = np.linalg.inv((G + G.T) / 2).astype(np.float64)
        self._patch = CondensedCells.on_springs(part, moving, self._start, stiffness)
        self._balance = self._patch.force(self._start) - self._load[self._dofs]
        self._balance += self._patch.stable @ self._let_go[self._dofs]

    def __call__(self, force: FloatArray) -> LocalSolution:
        """Return the solution for a force field (n_points, 3) in N, zero beside D."""
        f = self._pattern.unknowns(force)[self._dofs]
        found = minimise(self._patch, f + self._balance, self._start)
        moved = found.x - self._start - self._let_go[self._dofs]
        pull = (self._patch.stable @ moved).astype(np.float32)
        x = self._state + self._let_go + pull @ self._columns
        return LocalSolution(self._pattern.on_points(x), found.converged, found.steps)

    @property
    def n_bytes(self) -> int:
        """Memory of the columns and of the patch's stiffnesses."""
        return self._columns.nbytes + 2 * self._patch.stable.nbytes


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
        response = linear.solve(unit)
        columns[first : first + len(some)] = response
        G[first : first + len(some)] = response[:, dofs]
    return columns, G

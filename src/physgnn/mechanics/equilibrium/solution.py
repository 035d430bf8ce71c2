"""What a solve gives back: displacement, and an honest status for every level."""

import time
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.mechanics.loads.paths import LoadPath


class Status(IntEnum):
    """How a load level ended. The text of each is its remedy."""

    CONVERGED = 0
    LIMIT_POINT = 1
    INVERTED = 2
    ITERATION_LIMIT = 3
    NOT_SOLVED = 4
    NOT_REACHED = 5

    @property
    def remedy(self) -> str:
        """One line: what happened and what to do."""
        return _REMEDY[self]

    def stopped_at(self, load_factor: float, inverted: int = -1) -> str:
        """One line on a path that ended so: where, why, and at which cell if at one."""
        cell = f" (cell {inverted})" if inverted >= 0 else ""
        return f"stopped at load factor {load_factor:.4f}: {self.remedy}{cell}"

    def __str__(self) -> str:
        return self.name.lower().replace("_", " ")


_REMEDY = {
    Status.CONVERGED: "in equilibrium within the tolerance",
    Status.LIMIT_POINT: "the load path reached a limit point: lower the force",
    Status.INVERTED: "an element inverted: refine the mesh there or lower the force",
    Status.ITERATION_LIMIT: "the iteration cap was met: raise max_iterations",
    Status.NOT_SOLVED: "not computed yet: run the simulation again to resume it",
    Status.NOT_REACHED: "an earlier level of this path failed",
}


@dataclass(frozen=True, eq=False)
class Solution:
    """Equilibrium states along a load path.

    Attributes
    ----------
    displacement : (n_levels, n_points, 3) array
        mm; zero at levels that are not converged.
    status : (n_levels,) int8 array of `Status`
        One a level.
    residual : (n_levels,) array
        ‖internal − external force‖ over free points / ‖external force‖.
    load_factors : (n_levels,) array
        The load factors solved for.
    reached : float
        The highest load factor in equilibrium, between levels included.
    message : str
        Why the path ended early, and where it snapped through to another equilibrium;
        empty if it did neither.
    seconds : float
        Wall-clock time, without that of others among which it was solved.
    counts : dict of str to int
        Factorisations, back-solves and residuals spent.
    """

    displacement: FloatArray
    status: NDArray[np.int8]
    residual: FloatArray
    load_factors: FloatArray
    reached: float
    message: str
    seconds: float
    counts: dict[str, int]

    @property
    def converged(self) -> bool:
        """Whether every level is in equilibrium."""
        return bool((self.status == Status.CONVERGED).all())


class LevelRecord:
    """The levels of a path as they are solved, one after another.

    Parameters
    ----------
    path : LoadPath
    n_points : int
        Of the mesh.
    """

    def __init__(self, path: LoadPath, n_points: int) -> None:
        self._started = time.perf_counter()
        self._load_factors = path.load_factors
        self._displacement = np.zeros((path.n_levels, n_points, 3))
        self._status = np.full(path.n_levels, Status.NOT_REACHED, dtype=np.int8)
        self._residual = np.full(path.n_levels, np.nan)

    def keep(self, level: int, displacement: FloatArray, residual: float) -> None:
        """Note that a level converged: its displacement, mm, and relative residual."""
        self._status[level] = Status.CONVERGED
        self._displacement[level], self._residual[level] = displacement, residual

    def stop(self, level: int, status: Status) -> None:
        """Note why the path ends before a level."""
        self._status[level] = status

    def solution(
        self, *, reached: float, message: str, counts: dict[str, int]
    ) -> Solution:
        """Return all of them."""
        return Solution(
            displacement=self._displacement,
            status=self._status,
            residual=self._residual,
            load_factors=self._load_factors,
            reached=reached,
            message=message,
            seconds=time.perf_counter() - self._started,
            counts=counts,
        )

"""Load paths solved side by side, which share the factor of the state at rest.

All load paths of a body begin at rest, and most of their back-solves are with the
factor of that state. A back-solve reads the whole factor from memory, for four
right-hand sides as for one. So paths go side by side, each in a thread of its own, and
what they want solved with that factor is solved together.

They take turns: a path goes on until it has a right-hand side for the shared factor,
and waits. Once all wait, all are solved. A path that wants the factor of another state
has one of its own, and keeps its turn to its end, so that the factors of two such paths
are never needed at once.
"""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Condition, Lock

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.linear.protocols import LinearSolver
from physgnn.mechanics.linear.right_sides import solve_each


class StoppedError(Exception):
    """Paths side by side were told to stop."""


class SharedFactor:
    """The factor of the first tangent that is asked for.

    Parameters
    ----------
    solver : LinearSolver
        Makes it and holds it.

    Attributes
    ----------
    positive : bool
        Whether that tangent is positive definite.
    """

    def __init__(self, solver: LinearSolver) -> None:
        self.solver, self.positive = solver, False
        self._data: FloatArray | None = None

    def is_of(self, data: FloatArray) -> bool:
        """Whether a tangent is the one that is shared."""
        if self._data is None:
            self._data, self.positive = data, self.solver.factorize(data)
        return np.array_equal(self._data, data)


@dataclass(eq=False)
class _Request:
    factor: SharedFactor
    right: FloatArray
    solved: FloatArray | Exception | None = None
    seconds: float = 0.0  # its share of the solving


class Company:
    """The paths that walk side by side: whose turn it is, and what they wait for."""

    def __init__(self) -> None:
        self._turn, self._changed = Lock(), Condition()
        self._n_walking, self._waiting = 0, list[_Request]()
        self._stopped = False

    @contextmanager
    def walk(self) -> Iterator[None]:
        """Walk along one path among the others: this waits for a turn."""
        with self._changed:
            self._n_walking += 1
        try:
            with self._turn:
                self.check()
                yield
        finally:
            with self._changed:
                self._n_walking -= 1
                self._changed.notify_all()

    def stop(self) -> None:
        """Let every path, now or to come, raise `StoppedError` when it next solves."""
        self._stopped = True

    def check(self) -> None:
        """Raise `StoppedError` if the paths are to stop."""
        if self._stopped:
            raise StoppedError

    def solve(
        self, factor: SharedFactor, right: FloatArray
    ) -> tuple[FloatArray, float]:
        """Give up the turn until a right-hand side is solved with those of others.

        Returns
        -------
        (n_unknowns,) array, float
            The solution, and the seconds that its solving took of those of all.
        """
        request = _Request(factor, right)
        self._turn.release()
        try:
            self._wait_for(request)
        finally:
            self._turn.acquire()
        if not isinstance(request.solved, np.ndarray):
            raise request.solved or StoppedError
        return request.solved, request.seconds

    def _wait_for(self, request: _Request) -> None:
        with self._changed:
            self._waiting.append(request)
            while request.solved is None:
                if len(self._waiting) < self._n_walking:
                    self._changed.wait()
                    continue
                _solve_all(self._waiting)
                self._waiting.clear()
                self._changed.notify_all()


def _solve_all(requests: list[_Request]) -> None:
    """Solve what paths wait for, with one factor after the other."""
    for factor in {request.factor for request in requests}:
        own = [request for request in requests if request.factor is factor]
        started = time.perf_counter()
        solved: Sequence[FloatArray | Exception]
        try:
            solved = solve_each(factor.solver, [request.right for request in own])
        except Exception as error:  # each path's, as if it had solved alone
            solved = [error] * len(own)
        seconds = (time.perf_counter() - started) / len(own)
        for request, answer in zip(own, solved, strict=True):
            request.solved, request.seconds = answer, seconds


class PathFactor:
    """The linear solver of one path among others.

    Parameters
    ----------
    company : Company
        In which the path walks.
    shared : SharedFactor
        Serves as long as the path wants the tangent that it begins with.
    spare : LinearSolver
        For any other tangent.

    Attributes
    ----------
    waited : float
        Seconds that went to others while this path waited for its right-hand sides.
    """

    def __init__(
        self, company: Company, shared: SharedFactor, spare: LinearSolver
    ) -> None:
        self._company, self._shared, self._spare = company, shared, spare
        self._at_rest: FloatArray | None = None
        self._rests = self._shares = True
        self.waited = 0.0

    def factorize(self, data: FloatArray) -> bool:
        """Factorise K, unless it is the shared one; False if not positive definite."""
        self._company.check()
        if self._at_rest is None:
            self._at_rest = data
        # Once a path has had a factor of its own it keeps its turn, and the spare.
        self._rests = self._rests and np.array_equal(self._at_rest, data)
        self._shares = self._rests and self._shared.is_of(data)
        return self._shared.positive if self._shares else self._spare.factorize(data)

    def solve(self, right: FloatArray) -> FloatArray:
        """Return K⁻¹ b, (n_unknowns,)."""
        self._company.check()
        if not self._rests:
            return self._spare.solve(right)
        if not self._shares:  # but might have, had it been the first to begin
            return solve_each(self._spare, [right])[0]
        started = time.perf_counter()
        solved, seconds = self._company.solve(self._shared, right)
        self.waited += time.perf_counter() - started - seconds
        return solved

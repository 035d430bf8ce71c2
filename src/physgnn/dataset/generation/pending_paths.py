"""Solve the pending load paths of a store, here or on many machines.

A path is written into its own chunks, and solved again only if it was not finished, so
a run may be killed at any moment and started again.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from typing import Any, Protocol

from physgnn.dataset.generation.work import Result, Work, each
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.io.febio.load_writer import check_writable
from physgnn.io.febio.run import FebioSolver
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.equilibrium.partial_renewal import LEAST_UNKNOWNS
from physgnn.mechanics.equilibrium.solution import Solution
from physgnn.mechanics.equilibrium.solver import Solver
from physgnn.mechanics.linear.right_sides import WIDTH
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.meshless.solver import MeshlessSolver
from physgnn.progress import Progress

ALREADY_THERE = "already there"
DEFAULT_SOLVER = "physgnn"
ABREAST = WIDTH
MOST_UNKNOWNS = 100_000


class CanSolve(Protocol):
    """What a solver offers."""

    def solve(self, path: LoadPath) -> Solution:
        """Find equilibrium at every level of a path."""


@dataclass(frozen=True)
class Generation:
    """What a run did.

    Attributes
    ----------
    solved : int
        Paths written in this run.
    errors : dict of int to str
        Paths that raised an error and are still pending, and what it said.
    """

    solved: int = 0
    errors: dict[int, str] = field(default_factory=dict)


def generate(
    store: Store,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Generation:
    """Solve and write every pending path.

    Parameters
    ----------
    store : Store
        Results go into it; its provenance may name the ``solver``.
    workers, scheduler
        See `physgnn.dataset.generation.work.each`.
    progress : callable, optional
        Called with the paths done, the paths in all, and how the last one ended.

    Returns
    -------
    Generation
        A path that reaches no equilibrium is written with the status that says why. One
        that raises an error does not stop the others, and stays pending.

    Raises
    ------
    InputError
        If `workers` is less than 1, the scheduler does not answer, or the solver is not
        installed.
    """
    pending = store.pending().tolist()
    where: dict[str, Any] = {"workers": workers, "scheduler": scheduler}
    with closing(each(SOLVE, store, pending, **where)) as results:
        return _gather(results, store, progress)


def _own_solver(store: Store) -> CanSolve:
    return Solver(store.body, side_by_side=paths_abreast(store) > 1)


def _febio_solver(store: Store) -> CanSolve:
    return FebioSolver(store.body)


def _meshless_solver(store: Store) -> CanSolve:
    return MeshlessSolver(store.body)


SOLVERS: Mapping[str, Callable[[Store], CanSolve]] = {
    "physgnn": _own_solver,
    "febio": _febio_solver,
    "mtled": _meshless_solver,
}
"""Solvers by the name that a store's provenance has."""
FINITE_ELEMENTS = ("physgnn", "febio")
"""Solvers whose solutions full Newton on the body's elements can check."""


def check_febio(element: str, paths: Sequence[LoadPath]) -> None:
    """Raise InputError if our FEBio models cannot describe this problem."""
    if element != DEFAULT_ELEMENT:
        raise InputError(
            f"for FEBio we write element '{DEFAULT_ELEMENT}': leave element out, or "
            "solve without FEBio"
        )
    for path in paths:
        check_writable(path.more)


def solver_of(store: Store) -> CanSolve:
    """Return the solver a store is made with; InputError if it is none of ours."""
    name = store.provenance.get("solver", DEFAULT_SOLVER)
    if name not in SOLVERS:
        raise InputError(
            f"store {store.path} was not made by one of our solvers ({name}): what it "
            "lacks can only be imported again"
        )
    return SOLVERS[name](store)


def solve_and_write(store: Store, solver: CanSolve, i: int) -> tuple[str, str]:
    """Solve path `i` and write it, unless another process has.

    Returns how it ended, and the error of the solver, empty if there was none.

    Raises
    ------
    InputError
        If the disk does not take the solution.
    """
    if not store.is_pending(i):
        return ALREADY_THERE, ""
    try:
        solution = solver.solve(store.load_path(i))
    except Exception as error:  # whatever it was, the other paths can be solved
        return "error", f"{type(error).__name__}: {error}"
    store.write(i, solution)
    return solution.message or "converged", ""


def paths_abreast(store: Store) -> int:
    """Return how many paths a process solves side by side, sharing a factor.

    Those of small bodies share it only at rest. Those of large ones would need much
    memory, and a run that is killed loses what it was at.
    """
    own = store.provenance.get("solver", DEFAULT_SOLVER) == DEFAULT_SOLVER
    fits = LEAST_UNKNOWNS <= 3 * store.mesh.n_points <= MOST_UNKNOWNS
    return ABREAST if own and fits else 1


def _stop(solver: Solver) -> None:
    solver.stop()


SOLVE = Work(solver_of, solve_and_write, paths_abreast, _stop)


def _gather(
    results: Iterable[Result], store: Store, progress: Progress | None
) -> Generation:
    solved, errors = 0, {}
    done = store.n_paths - len(store.pending())
    for i, ended, error in results:
        done += 1
        solved += not error and ended != ALREADY_THERE
        if error:
            errors[i] = error
        if progress:
            progress(done, store.n_paths, f"load path {i}: {ended}")
    return Generation(solved, errors)

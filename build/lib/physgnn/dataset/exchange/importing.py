"""Datasets of other solvers' results: meshless, SOFA, FEBio, measured."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.dataset.presets import BRAIN_AND_TUMOUR
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.plausibility import check_millimetres
from physgnn.io.array_files import read_arrays
from physgnn.io.febio.model_reader import read_febio_results
from physgnn.io.integrity.atomic import whole_folder
from physgnn.io.simulation import Simulation
from physgnn.io.vtk.series import read_series
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.loads.external_force import Loading
from physgnn.mechanics.materials import Material
from physgnn.progress import Progress
from physgnn.versions import release

Reader = Callable[[Path], list[Simulation]]

FOLDER = "a folder"
# How far other solvers' held points may be off, mm: penalties hold them nearly.
MOST_OF_FIXED_MM = 0.01
READERS: Mapping[str, Reader] = {
    ".feb": read_febio_results,
    ".npz": read_arrays,
    FOLDER: read_series,
}
"""Formats by suffix; see the modules of the readers for what they expect."""


def read_simulations(source: str | Path) -> list[Simulation]:
    """Read the load paths of a .feb model and its log, an .npz, or a folder of VTU.

    Raises
    ------
    InputError
        If it is none of these, or not what its reader expects.
    """
    path = Path(source)
    kind = FOLDER if path.is_dir() else path.suffix
    if kind not in READERS:
        raise InputError(
            f"{path}: expected {', '.join(READERS)} of .vtu files (got '{path.suffix}')"
        )
    if not path.exists():
        raise InputError(f"{path}: no such file")
    return READERS[kind](path)


def import_results(
    sources: Sequence[str | Path],
    store: str | Path,
    *,
    materials: Mapping[int, Material] = BRAIN_AND_TUMOUR,
    element: str = DEFAULT_ELEMENT,
    progress: Progress | None = None,
) -> Store:
    """Make a store of other solvers' results.

    Parameters
    ----------
    sources : sequence of path
        See `read_simulations`; all on one mesh, with the same fixed points.
    store : path
        A folder that does not exist yet.
    materials : mapping of region to Material
        For sources that do not name theirs.
    element : str
        As in `physgnn.mechanics.SolverOptions`: what repairs and error bounds of
        networks trained on the results compute with.
    progress : callable, optional
        Called with the load paths done, in all, and where the last came from.

    Raises
    ------
    InputError
        If a source is wrong or does not fit the first one. No store is left then.
    """
    target = Path(store)
    if target.exists():
        raise InputError(f"{target} exists already: name another store")
    found = [s for source in sources for s in read_simulations(source)]
    if not found:
        raise InputError("nothing to import: name one source or more")
    longest = max((s.load_path.load_factors for s in found), key=len)
    check_millimetres(found[0].mesh.points, found[0].source)
    for simulation in found:
        _check_same(simulation, found[0], longest)
    with whole_folder(target) as part:
        made = Store.create(
            part,
            Body(
                found[0].mesh,
                found[0].materials or materials or {},
                found[0].fixed,
                element=element,
            ),
            [replace(s.load_path, load_factors=longest) for s in found],
            provenance={
                "solver": "imported",
                "imported_from": [str(source) for source in sources],
                "physgnn": release("physgnn"),
            },
        )
        for i, simulation in enumerate(found):
            solution = simulation.read_solution()
            _check_fixed(simulation, solution)
            made.write(i, _extended(solution, longest))
            if progress:
                progress(i + 1, len(found), simulation.source)
    return Store.open(target)


def _check_same(
    simulation: Simulation, first: Simulation, longest: np.ndarray[Any, Any]
) -> None:
    """Raise InputError if a source is of another body or other levels."""
    n, expected = simulation.mesh.n_points, first.mesh.n_points
    factors = simulation.load_path.load_factors
    reasons = (
        (n != expected, f"has {n} points, and {first.source} {expected}"),
        (
            simulation.mesh.content_hash != first.mesh.content_hash,
            f"has another mesh than {first.source}",
        ),
        (
            not np.array_equal(np.sort(simulation.fixed), np.sort(first.fixed)),
            f"holds other points than {first.source}",
        ),
        (
            simulation.materials != first.materials,
            f"has other materials than {first.source}",
        ),
        (
            not np.allclose(factors, longest[: len(factors)], rtol=1e-9),
            f"has load factors {factors[0]:g} … {factors[-1]:g}, which are not the "
            f"first {len(factors)} of {longest[0]:g} … {longest[-1]:g}",
        ),
    )
    for differs, reason in reasons:
        if differs:
            raise InputError(f"{simulation.source}: {reason}: import them apart")
    try:
        Loading(first.mesh, simulation.load_path, first.fixed)
    except InputError as error:
        raise InputError(f"{simulation.source}: {error}") from error


def _check_fixed(simulation: Simulation, solution: Solution) -> None:
    """Raise InputError if points move that are held."""
    moved = np.abs(solution.displacement[:, simulation.fixed]).max(initial=0.0)
    if moved > MOST_OF_FIXED_MM:
        raise InputError(
            f"{simulation.source}: its fixed points must not move (they do, by up to "
            f"{moved:.3g} mm): give displacements from the mesh at rest, not "
            "positions, and as fixed the points that the solver held"
        )


def _extended(solution: Solution, longest: np.ndarray[Any, Any]) -> Solution:
    """Return a solution with levels that were not reached up to the last."""
    missing = len(longest) - len(solution.status)
    if missing == 0:
        return solution
    shape = (missing, *solution.displacement.shape[1:])
    status = np.full(missing, Status.NOT_REACHED, dtype=np.int8)
    status[0] = Status.ITERATION_LIMIT
    return Solution(
        displacement=np.concatenate([solution.displacement, np.zeros(shape)]),
        status=np.concatenate([solution.status, status]),
        residual=np.concatenate([solution.residual, np.full(missing, np.nan)]),
        load_factors=longest,
        reached=solution.reached,
        message=solution.message or f"stopped at load factor {solution.reached:.4f}",
        seconds=solution.seconds,
        counts={},
    )

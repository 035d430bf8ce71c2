"""A load path solved by somebody else, in whatever file: one type for all formats."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import Material


@dataclass(frozen=True, eq=False)
class Simulation:
    """The problem that was solved, and how to read its solution.

    Attributes
    ----------
    source : str
        Where it comes from, for messages.
    mesh : TetMesh
    fixed : (n_fixed,) integer array
    load_path : LoadPath
    materials : mapping of region to Material, or None
        None if the format does not tell.
    read_solution : callable
        Reads the solution; raises InputError if it does not fit.
    """

    source: str
    mesh: TetMesh
    fixed: IntArray
    load_path: LoadPath
    materials: Mapping[int, Material] | None
    read_solution: Callable[[], Solution]


def solution_of(displacement: FloatArray, load_factors: FloatArray) -> Solution:
    """Return the solution that displacements make, levels of NaN not converged.

    Parameters
    ----------
    displacement : (n_levels, n_points, 3) array
        mm; NaN where the solver found no equilibrium.
    load_factors : (n_levels,) array

    Returns
    -------
    Solution
        How close to equilibrium the levels came was not recorded: their residual is
        NaN.
    """
    found = np.isfinite(displacement.sum(axis=(1, 2)))
    status = np.where(found, Status.CONVERGED, Status.NOT_REACHED).astype(np.int8)
    status[np.flatnonzero(~found)[:1]] = Status.ITERATION_LIMIT
    reached = float(load_factors[found].max(initial=0.0))
    return Solution(
        displacement=np.where(found[:, None, None], displacement, 0.0),
        status=status,
        residual=np.full(len(load_factors), np.nan),
        load_factors=load_factors,
        reached=reached,
        message="" if found.all() else f"stopped at load factor {reached:.4f}",
        seconds=0.0,
        counts={},
    )

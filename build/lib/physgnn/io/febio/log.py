"""Reads FEBio's log of nodal displacements, ``node_data data="ux;uy;uz"``.

Every step prints three lines that start with an asterisk (step, time, data) and then
a line ``id ux uy uz`` a node; only steps in equilibrium are printed.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.io.simulation import solution_of
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.text import read_text
from physgnn.mechanics.equilibrium.solution import Solution
from physgnn.mechanics.loads.paths import LoadPath

SAME_TIME = 1e-6  # FEBio prints nine digits of the time
DELIMITERS = str.maketrans(",;\t", "   ")


def read_febio_log(
    path: str | Path,
    load_path: LoadPath,
    *,
    times: FloatArray,
    node_ids: IntArray,
) -> Solution:
    """Read the displacement at every level of a load path.

    Parameters
    ----------
    path : path
        The log.
    load_path : LoadPath
        What was solved.
    times : (n_levels,) array
        When FEBio reached its levels.
    node_ids : (n_points,) integer array
        FEBio's id of every point, increasing.

    Returns
    -------
    Solution
        Levels that are not in the log were not reached.

    Raises
    ------
    InputError
        If the log is missing, is of other nodes, or has a time that is no step's end.
    """
    path = Path(path)
    with reading(path, "a FEBio log of displacements"):
        displacement = np.full((len(times), len(node_ids), 3), np.nan)
        for time, rows in _blocks(path):
            if time == 0:
                continue
            level = int(np.abs(times - time).argmin())
            if not abs(times[level] - time) <= SAME_TIME * time:
                raise InputError(
                    f"{path}: time {time:g} ends none of the {len(times)} steps: run "
                    "FEBio without automatic time stepping"
                )
            displacement[level] = _placed(path, time, rows, node_ids)
        return solution_of(displacement, load_path.load_factors)


def _blocks(path: Path) -> Iterator[tuple[float, list[str]]]:
    """Yield time and lines of every step."""
    lines = read_text(path, names_in_latin1=True).splitlines()
    starts = [i for i, line in enumerate(lines) if line.startswith("*Time")]
    if not starts:
        raise InputError(f"{path}: no line '*Time = …': is it a node_data log?")
    for start, end in zip(starts, [*starts[1:], len(lines)], strict=True):
        rows = [row for row in lines[start:end] if row and not row.startswith("*")]
        yield float(lines[start].partition("=")[2]), rows


def _placed(path: Path, time: float, rows: list[str], node_ids: IntArray) -> FloatArray:
    """Return the displacement of a step in the order of the mesh's points."""
    try:
        table = np.array(
            [row.translate(DELIMITERS).split() for row in rows], dtype=float
        )
        table = table.reshape(-1, 4)
    except ValueError as error:
        raise InputError(f"{path}: expected 'id ux uy uz' at time {time:g}") from error
    table = table[np.argsort(table[:, 0])]
    if len(table) != len(node_ids) or (table[:, 0] != node_ids).any():
        raise InputError(
            f"{path}: has {len(table)} nodes at time {time:g}, the model "
            f"{len(node_ids)}: log all nodes of that model"
        )
    return table[:, 1:]

"""Results as NumPy arrays in one .npz file: the simplest for another solver to write.

| array | shape | |
|---|---|---|
| ``points`` | (n_points, 3) | mm, at rest |
| ``cells`` | (n_cells, 4) | 0-based, positive volume |
| ``region`` | (n_cells,) | 0 brain, 1 tumour, 2 ventricle |
| ``fixed`` | (n_fixed,) | points held at zero displacement |
| ``load_nodes`` | (n_paths, n_loaded) | −1 where a path loads fewer |
| ``load_vectors`` | (n_paths, n_loaded, 3) | N, at load factor 1 |
| ``load_factors`` | (n_levels,) | increasing, in (0, 1] |
| ``displacement`` | (n_paths, n_levels, n_points, 3) | mm; NaN: no equilibrium found |

With one load path the first axis of the last four but ``load_factors`` may be left out.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.array_checks import checked_numbers
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.integrity.atomic import whole_file
from physgnn.io.simulation import Simulation, solution_of
from physgnn.io.untrusted.compressed import read_npz
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.numbers import real_numbers, whole_numbers
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.loads.paths import LoadPath

Arrays = Mapping[str, np.ndarray[Any, Any]]

MESH = ("points", "cells", "region", "fixed")
WHOLE = ("cells", "region", "fixed", "load_nodes")
AXES = {"load_nodes": 2, "load_vectors": 3, "load_factors": 1, "displacement": 4}


def read_arrays(path: Path) -> list[Simulation]:
    """Read load paths and their solutions.

    Raises
    ------
    InputError
        If an array is missing, or does not fit the others.
    """
    found = read_npz(path)
    with reading(path, "results as arrays"):
        return _simulations(str(path), _checked(found))


def write_arrays(path: str | Path, simulations: Sequence[Simulation]) -> None:
    """Write load paths on one mesh; `read_arrays` gives them back exactly.

    Raises
    ------
    InputError
        If the name does not end in .npz or the folder is missing.
    """
    path = Path(path)
    if path.suffix.lower() != ".npz":
        raise InputError(f"{path}: arrays are written as .npz (got '{path.suffix}')")
    first = simulations[0]
    widest = max(len(s.load_path.nodes) for s in simulations)
    arrays: dict[str, Any] = {
        **{name: getattr(first.mesh, name) for name in MESH[:3]},
        "fixed": first.fixed,
        "load_nodes": np.full((len(simulations), widest), -1),
        "load_vectors": np.zeros((len(simulations), widest, 3)),
        "load_factors": first.load_path.load_factors,
    }
    displacement = []
    for i, simulation in enumerate(simulations):
        loaded = slice(len(simulation.load_path.nodes))
        arrays["load_nodes"][i, loaded] = simulation.load_path.nodes
        arrays["load_vectors"][i, loaded] = simulation.load_path.forces
        solution = simulation.read_solution()
        lost = solution.status != Status.CONVERGED
        displacement.append(
            np.where(lost[:, None, None], np.nan, solution.displacement)
        )
    with whole_file(path) as part:
        np.savez(part, **arrays, displacement=np.stack(displacement))


def _checked(found: dict[str, np.ndarray[Any, Any]]) -> Arrays:
    missing = [name for name in (*MESH, *AXES) if name not in found]
    if missing:
        raise InputError(
            f"has no array '{missing[0]}' (it has: {', '.join(found) or 'none'})"
        )
    for name in (*MESH, *AXES):
        check = whole_numbers if name in WHOLE else real_numbers
        found[name] = check(found[name], name)
    for name, axes in AXES.items():
        if name != "load_factors" and found[name].ndim == axes - 1:
            found[name] = found[name][None]
        if found[name].ndim != axes:
            raise InputError(f"{name} must have {axes} axes (got {found[name].shape})")
    n_paths, n_loaded = found["load_nodes"].shape
    n_levels, n_points = len(found["load_factors"]), len(found["points"])
    for name, shape in (
        ("load_vectors", (n_paths, n_loaded, 3)),
        ("displacement", (n_paths, n_levels, n_points, 3)),
    ):
        if found[name].shape != shape:
            raise InputError(
                f"{name} must have shape {shape}, by the shapes of points, load_nodes "
                f"and load_factors (got {found[name].shape})"
            )
    return found


def _simulations(source: str, arrays: Arrays) -> list[Simulation]:
    mesh = TetMesh(
        arrays["points"],
        arrays["cells"],
        arrays["region"],
        point_sets={"fixed": arrays["fixed"]},
    )
    fixed = mesh.point_set("fixed")
    factors = checked_numbers(arrays["load_factors"], "load_factors")
    simulations = []
    for i, (nodes, forces) in enumerate(
        zip(arrays["load_nodes"], arrays["load_vectors"], strict=True)
    ):
        load_path = LoadPath(nodes[nodes >= 0], forces[nodes >= 0], factors)
        read = partial(solution_of, arrays["displacement"][i], factors)
        name = f"{source}, load path {i}"
        simulations.append(Simulation(name, mesh, fixed, load_path, None, read))
    return simulations

"""Load cases and datasets for other programs."""

from functools import partial
from pathlib import Path

import numpy as np

from physgnn.dataset.generation.pending_paths import check_febio
from physgnn.dataset.presets import Preset, find_preset
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.io import read_mesh
from physgnn.io.array_files import write_arrays
from physgnn.io.febio.model_writer import write_febio
from physgnn.io.simulation import Simulation
from physgnn.io.vtk.series import write_series
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution


def export_febio(
    source: str | Path,
    out: str | Path,
    *,
    preset: str | Preset | None = None,
    path: int = 0,
) -> None:
    """Write a load path as a FEBio model that FEBio runs as it is.

    Parameters
    ----------
    source : path
        A mesh (.vtu), or a dataset.
    out : path
        The .feb file.
    preset : str or Preset, optional
        The loads of a mesh; a dataset has its own.
    path : int
        Which load path.

    Raises
    ------
    InputError
        If a mesh has no preset or a dataset has one, or there is no such path.
    """
    if Path(source).is_dir() == (preset is not None):
        raise InputError("a mesh needs --preset or --loads, a dataset neither")
    if preset is None:
        store = Store.open(source)
        _check_path(path, store.n_paths)
        body, load_path = store.body, store.load_path(path)
    else:
        preset = find_preset(preset) if isinstance(preset, str) else preset
        mesh, paths = preset.on(read_mesh(source))
        _check_path(path, len(paths))
        load_path = paths[path]
        body = Body(mesh, preset.materials, element=preset.element)
    check_febio(body.element, [load_path])
    write_febio(out, body, load_path)


def export_arrays(source: str | Path, out: str | Path) -> None:
    """Write a whole dataset as arrays, see `physgnn.io.array_files`.

    Raises
    ------
    InputError
        If a load path has more than nodal forces, for which there are no arrays.
    """
    store = Store.open(source)
    for i in range(store.n_paths):
        if store.load_path(i).more:
            raise InputError(
                f"the arrays hold nodal forces alone, and load path {i} of {source} "
                "has other loads: write it with --series"
            )
    write_arrays(out, [simulation_of(store, i) for i in range(store.n_paths)])


def export_series(source: str | Path, out: str | Path, *, path: int = 0) -> None:
    """Write a load path of a dataset as VTU files, see `physgnn.io.vtk.series`."""
    store = Store.open(source)
    _check_path(path, store.n_paths)
    write_series(out, simulation_of(store, path))


def simulation_of(store: Store, i: int) -> Simulation:
    """Return load path `i` as the writers of `physgnn.io` take it."""
    return Simulation(
        f"{store.path}, load path {i}",
        store.mesh,
        store.fixed,
        store.load_path(i),
        store.materials,
        partial(_stored, store, i),
    )


def _stored(store: Store, i: int) -> Solution:
    return Solution(
        displacement=store.displacement(i).astype(np.float64),
        status=store.status[i],
        residual=store.residual[i].astype(np.float64),
        load_factors=store.load_factors,
        reached=float(store.reached[i]),
        message=store.message(i),
        seconds=float(store.seconds[i]),
        counts={},
    )


def _check_path(path: int, n_paths: int) -> None:
    if not 0 <= path < n_paths:
        raise InputError(f"load path must be in 0…{n_paths - 1} (got {path})")

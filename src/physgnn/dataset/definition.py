"""What a dataset asks: mesh, materials, fixed points and load paths, on disk."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from numpy.typing import NDArray

from physgnn.dataset import layout
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads import LoadPath
from physgnn.mechanics.materials import Material
from physgnn.mechanics.materials.table import material_to_config


def check(
    mesh: TetMesh,
    paths: Sequence[LoadPath],
    materials: Mapping[int, Material],
    fixed: NDArray[np.int64],
) -> None:
    """Raise InputError if paths, materials and mesh do not fit each other."""
    if not paths:
        raise InputError("a dataset needs one load path or more (got none)")
    for i, path in enumerate(paths):
        path.check_against(mesh, fixed)
        if not np.array_equal(path.load_factors, paths[0].load_factors):
            raise InputError(
                f"all load paths must have the same load factors (path {i} differs)"
            )
    without = sorted(set(np.unique(mesh.region).tolist()) - set(materials))
    if without:
        raise InputError(f"region {without[0]} has no material: name one for it")


def write(
    folder: Path,
    mesh: TetMesh,
    paths: Sequence[LoadPath],
    *,
    materials: Mapping[int, Material],
    fixed: NDArray[np.int64],
    provenance: Mapping[str, Any],
) -> None:
    """Write a new store at `folder`, every path pending."""
    group = zarr.open_group(folder, mode="w-")
    attributes: dict[str, Any] = {
        "format": layout.FORMAT,
        "version": layout.VERSION,
        "n_paths": len(paths),
        "n_points": mesh.n_points,
        "mesh_hash": mesh.content_hash,
        "point_sets": sorted(mesh.point_sets),
        "materials": {str(k): material_to_config(m) for k, m in materials.items()},
        "provenance": dict(provenance),
    }
    group.attrs.update(attributes)
    nodes, forces = _padded(paths)
    arrays: dict[str, NDArray[Any]] = {
        "mesh/points": mesh.points,
        "mesh/cells": mesh.cells,
        "mesh/region": mesh.region,
        **{f"mesh/point_sets/{name}": ids for name, ids in mesh.point_sets.items()},
        "fixed": np.asarray(fixed, dtype=np.int64),
        "loads/nodes": nodes,
        "loads/forces": forces,
        "load_factors": paths[0].load_factors,
    }
    for name, value in arrays.items():
        layout.put_array(group, name, value)
    rows = layout.result_arrays(paths[0].n_levels, mesh.n_points)
    for name, (shape, dtype, fill) in rows.items():
        layout.put_rows(group, f"result/{name}", (len(paths), *shape), dtype, fill)


def _padded(
    paths: Sequence[LoadPath],
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return nodes and forces of all paths as wide as the widest; node −1 is none."""
    widest = max(len(path.nodes) for path in paths)
    nodes = np.full((len(paths), widest), -1, dtype=np.int64)
    forces = np.zeros((len(paths), widest, 3))
    for i, path in enumerate(paths):
        nodes[i, : len(path.nodes)] = path.nodes
        forces[i, : len(path.nodes)] = path.forces
    return nodes, forces

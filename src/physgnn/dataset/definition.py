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


def materials_of(
    mesh: TetMesh, materials: Mapping[int, Material]
) -> dict[int, Material]:
    """Return the materials of the mesh's regions; InputError if one has none."""
    regions = np.unique(mesh.region).tolist()
    without = [region for region in regions if region not in materials]
    if without:
        raise InputError(f"region {without[0]} has no material: name one for it")
    return {region: materials[region] for region in regions}


def check(mesh: TetMesh, paths: Sequence[LoadPath], fixed: NDArray[np.int64]) -> None:
    """Raise InputError if the paths do not fit the mesh or each other."""
    if not paths:
        raise InputError("a dataset needs one load path or more (got none)")
    for i, path in enumerate(paths):
        path.check_against(mesh, fixed)
        if path.more:
            raise InputError(
                f"a dataset keeps nodal forces alone; path {i} has other loads too"
            )
        if not np.array_equal(path.load_factors, paths[0].load_factors):
            raise InputError(
                f"all load paths must have the same load factors (path {i} differs)"
            )


def digest(
    mesh: TetMesh,
    paths: Sequence[LoadPath],
    materials: Mapping[int, Material],
    fixed: NDArray[np.int64],
) -> str:
    """Return the SHA-256 of what is asked: two stores that ask the same share it."""
    return layout.digest_of(
        mesh.content_hash,
        _material_records(materials),
        np.asarray(fixed, dtype=np.int64),
        *_padded(paths),
        paths[0].load_factors,
    )


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
        "materials": _material_records(materials),
        "definition_hash": digest(mesh, paths, materials, fixed),
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


def _material_records(materials: Mapping[int, Material]) -> dict[str, Any]:
    return {str(region): material_to_config(m) for region, m in materials.items()}


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

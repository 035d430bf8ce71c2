"""What a dataset is to solve: mesh, element, materials, fixed points, load paths."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage import layout
from physgnn.dataset.storage.attributes import FORMAT, VERSION, with_root
from physgnn.dataset.storage.load_records import distinct, to_record
from physgnn.dataset.storage.result_rows import result_arrays
from physgnn.errors import InputError
from physgnn.io.integrity.digest import digest_of
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.loads.external_force import Loading
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials.table import material_to_config
from physgnn.mechanics.support import check_held


@dataclass(frozen=True, eq=False)
class Definition:
    """The problems that a dataset holds, complete and consistent.

    Attributes
    ----------
    body : Body
        What is loaded; materials of regions that its mesh lacks are left out.
    paths : sequence of LoadPath
        One or more, all with the same load factors.
    training_paths : int
        So many of them, the last, are for training alone.

    Raises
    ------
    InputError
        If a path does not fit, or leaves a part of the body free to move.
    """

    body: Body
    paths: Sequence[LoadPath]
    training_paths: int = 0

    def __post_init__(self) -> None:
        _check_paths(self.body, self.paths)

    @property
    def digest(self) -> str:
        """SHA-256 of the definition: stores of the same problems have the same."""
        nodes, forces = _padded(self.paths)
        loads, of_path = distinct(self.paths)
        beyond: list[Any] = [self.body.element, of_path, *loads]
        if self.body.element == DEFAULT_ELEMENT and not loads:
            beyond = []  # as for stores made before there was any of it
        if self.training_paths:
            beyond.append(self.training_paths)
        return digest_of(
            self.body.mesh.content_hash,
            _records(self.body),
            self.body.fixed,
            nodes,
            forces,
            self.paths[0].load_factors,
            *beyond,
        )

    def write(self, folder: Path, provenance: Mapping[str, Any]) -> None:
        """Write a new store at `folder`, every path pending."""
        import zarr

        group = zarr.open_group(folder, mode="w-")
        loads, of_path = distinct(self.paths)
        records = [to_record(load) for load in loads.values()]
        arrays = self._arrays()
        for k, (_, of_load) in enumerate(records):
            arrays |= {f"loads/more/{k}/{name}": v for name, v in of_load.items()}
        if loads:
            arrays["loads/more_of_path"] = of_path
        attributes: dict[str, Any] = {
            "format": FORMAT,
            "version": VERSION,
            "n_paths": len(self.paths),
            "training_paths": self.training_paths,
            "n_points": self.body.mesh.n_points,
            "mesh_hash": self.body.mesh.content_hash,
            "point_sets": sorted(self.body.mesh.point_sets),
            "element": self.body.element,
            "materials": _records(self.body),
            "more_loads": [record for record, _ in records],
            "definition_hash": self.digest,
            "provenance": dict(provenance),
            "arrays": {name: digest_of(value) for name, value in arrays.items()},
        }
        group.attrs.update(with_root(attributes))
        for name, value in arrays.items():
            layout.put_array(group, name, value)
        rows = result_arrays(self.paths[0].n_levels, self.body.mesh.n_points)
        for name, (shape, dtype, fill) in rows.items():
            of_all = (len(self.paths), *shape)
            layout.put_rows(group, f"result/{name}", of_all, dtype, fill)

    def _arrays(self) -> dict[str, NDArray[Any]]:
        mesh = self.body.mesh
        nodes, forces = _padded(self.paths)
        return {
            "mesh/points": mesh.points,
            "mesh/cells": mesh.cells,
            "mesh/region": mesh.region,
            **{f"mesh/point_sets/{name}": ids for name, ids in mesh.point_sets.items()},
            "fixed": self.body.fixed,
            "loads/nodes": nodes,
            "loads/forces": forces,
            "load_factors": self.paths[0].load_factors,
        }


def _check_paths(body: Body, paths: Sequence[LoadPath]) -> None:
    """Raise InputError if the paths do not fit the body or each other."""
    mesh, fixed = body.mesh, body.fixed
    if not paths:
        raise InputError("a dataset needs one load path or more (got none)")
    nothing = np.empty(0, dtype=np.int64)
    checked: set[bytes] = set()  # most paths hold the same points, or none
    for i, path in enumerate(paths):
        path.check_against(mesh, fixed)
        held = Loading(mesh, path, fixed).held if path.more else nothing
        if held.tobytes() not in checked:
            check_held(mesh, np.union1d(fixed, held))
            checked.add(held.tobytes())
        if not np.array_equal(path.load_factors, paths[0].load_factors):
            raise InputError(
                f"all load paths must have the same load factors (path {i} differs)"
            )


def _records(body: Body) -> dict[str, Any]:
    """Return the materials of the regions that the mesh has."""
    return {
        str(region): material_to_config(body.materials[region])
        for region in np.unique(body.mesh.region).tolist()
    }


def _padded(
    paths: Sequence[LoadPath],
) -> tuple[IntArray, FloatArray]:
    """Return nodes and forces of all paths as wide as the widest; node −1 is none."""
    widest = max(len(path.nodes) for path in paths)
    nodes = np.full((len(paths), widest), -1, dtype=np.int64)
    forces = np.zeros((len(paths), widest, 3))
    for i, path in enumerate(paths):
        nodes[i, : len(path.nodes)] = path.nodes
        forces[i, : len(path.nodes)] = path.forces
    return nodes, forces

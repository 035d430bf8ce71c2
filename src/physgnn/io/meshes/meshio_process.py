"""meshio's readers, which may hang or take all memory without harm to anybody else.

`physgnn.io.untrusted.reader_process` runs this file, which imports NumPy and meshio
alone: see `physgnn.io.meshes.reader` for the other side.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

VTK_TYPES = {
    "vertex": 1, "line": 3, "triangle": 5, "quad": 9, "tetra": 10, "hexahedron": 12,
    "wedge": 13, "pyramid": 14, "line3": 21, "triangle6": 22, "quad8": 23,
    "tetra10": 24, "hexahedron20": 25,
}  # fmt: skip
# By name, since meshio.read tries others, and exits where all fail.
READERS = {
    ".msh": "gmsh",
    ".inp": "abaqus",
    ".mesh": "medit",
    ".off": "off",
}
SETS = "element set"
GROUPS = "gmsh:physical"


def serve(request: dict[str, Any]) -> dict[str, Any]:
    """Return points, cells by blocks, integer cell arrays, and names as JSON."""
    import meshio

    path = Path(request["path"])
    mesh = getattr(meshio, READERS[path.suffix.lower()]).read(path)
    points = np.asarray(mesh.points, dtype=np.float64)
    if points.ndim == 2 and points.shape[1] == 2:
        points = np.pad(points, ((0, 0), (0, 1)))
    arrays: dict[str, Any] = {"points": points}
    for i, block in enumerate(mesh.cells):
        if block.type not in VTK_TYPES:
            raise ValueError(f"it has cells of a kind that is not known, {block.type}")
        arrays[f"cells_{i}"] = np.asarray(block.data)
    named = _cell_arrays(mesh)
    for i, values in enumerate(named.values()):
        arrays[f"array_{i}"] = values
    for i, ids in enumerate(mesh.point_sets.values()):
        arrays[f"set_{i}"] = np.asarray(ids, dtype=np.int64)
    text = {
        "types": [VTK_TYPES[block.type] for block in mesh.cells],
        "arrays": list(named),
        "names": _names(mesh),
        "sets": list(mesh.point_sets),
    }
    arrays["text"] = np.frombuffer(json.dumps(text).encode(), np.uint8)
    return arrays


def _cell_arrays(mesh: Any) -> dict[str, Any]:
    found = {
        name: np.concatenate([np.asarray(part) for part in parts])
        for name, parts in mesh.cell_data.items()
    }
    if mesh.cell_sets and GROUPS not in found:
        found[SETS] = _smallest_set(mesh)
    return found


def _smallest_set(mesh: Any) -> Any:
    """Return for every cell the smallest set that has it, from 1; 0 is none."""
    labels = [np.zeros(len(block.data), np.int64) for block in mesh.cells]
    sets = list(mesh.cell_sets.values())
    sizes = [sum(len(part) for part in parts if part is not None) for parts in sets]
    for i in sorted(range(len(sets)), key=lambda i: -sizes[i]):
        for label, part in zip(labels, sets[i], strict=False):
            if part is not None:
                label[np.asarray(part, dtype=np.int64)] = i + 1
    return np.concatenate(labels)


def _names(mesh: Any) -> dict[str, dict[str, str]]:
    """Return the names of numbers, by the array that they stand in."""
    groups = {
        str(int(value[0])): name
        for name, value in mesh.field_data.items()
        if len(value) == 2 and int(value[1]) == 3
    }
    sets = {str(i + 1): name for i, name in enumerate(mesh.cell_sets)}
    return {GROUPS: groups, SETS: sets}

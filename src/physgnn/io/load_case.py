"""Load cases as JSON: nodes by index, or by place on the surface.

Either of::

    {"nodes": [12, 30], "forces_n": [[0, 0, -0.2], [0, 0, -0.2]]}
    {"points": [[62.0, 129.1, 150.3]], "forces_n": [[0, 0, -1.0]]}

and, beside forces or alone, tissue that swells or contracts, each a
`physgnn.mechanics.loads.growth_rules.GrowthIn`::

    {"growth": [{"near": "tumour", "within_mm": 20, "volume_ratio": 1.05}]}
"""

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_points
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.integrity.atomic import write_whole
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.text import read_json
from physgnn.mechanics.loads.growth import VolumeGrowth
from physgnn.mechanics.loads.growth_rules import GrowthIn
from physgnn.mechanics.loads.paths import LoadCase, LoadPath

PLACES = ("nodes", "points")
FORCES = "forces_n"
GROWTH = "growth"
# A place farther from the surface than this is not meant to be on it: about the
# spacing of surface nodes.
SNAP_MM = 10.0


def read_load_case(
    path: str | Path, mesh: TetMesh, *, snap_mm: float = SNAP_MM
) -> LoadCase:
    """Read a load case and check that its nodes are the mesh's.

    Parameters
    ----------
    path : path
        JSON with ``forces_n``, N, and either ``nodes`` or ``points``, mm.
    mesh : TetMesh
        The mesh it acts on.
    snap_mm : float
        How far a point may lie from the surface node that takes its force. Forces on
        the same node add up.

    Returns
    -------
    LoadCase
        Nodes, and their forces in N.

    Raises
    ------
    InputError
        If the file is no such JSON, a node is not in the mesh, a point is far from
        the surface, a force is not three finite numbers, or the file holds growth.
    """
    load = read_load_path(path, mesh, snap_mm=snap_mm)
    if load.more:
        raise InputError(
            f"{path}: a load case is nodal forces alone, and this one holds growth: "
            "take it out, or read it as a load path"
        )
    return load.case(0)


def read_load_path(
    path: str | Path, mesh: TetMesh, *, snap_mm: float = SNAP_MM
) -> LoadPath:
    """Read a load case that may hold growth, as a path of one level.

    Parameters
    ----------
    path, mesh, snap_mm
        As of `read_load_case`; ``growth`` may stand beside forces or alone.

    Returns
    -------
    LoadPath
        Nodal forces, N, and growth.

    Raises
    ------
    InputError
        As `read_load_case`, or if growth names tissue that the mesh lacks or a volume
        ratio that tissue cannot have.
    """
    path = Path(path)
    content = read_json(path)
    with reading(path, "a load case"):
        more = _growth(content, mesh)
        if more and set(content) == {GROWTH}:
            return LoadPath.of(np.ones(1), *more)
        if more:
            content = {k: v for k, v in content.items() if k != GROWTH}
        case = _load_case(content, mesh, snap_mm)
        return LoadPath(case.nodes, case.forces, np.ones(1), more)


def write_load_case(path: str | Path, case: LoadCase) -> None:
    """Write a load case by nodes; `read_load_case` gives it back exactly.

    Parameters
    ----------
    path : path
        Where it goes, JSON.
    case : LoadCase
        Nodes, and their forces in N.
    """
    content = {"nodes": case.nodes.tolist(), FORCES: case.forces.tolist()}
    write_whole(Path(path), json.dumps(content) + "\n")


def _load_case(content: Any, mesh: TetMesh, snap_mm: float) -> LoadCase:
    places = [key for key in PLACES if isinstance(content, dict) and key in content]
    if len(places) != 1 or set(content) != {places[0], FORCES}:
        keys = list(content) if isinstance(content, dict) else type(content).__name__
        raise InputError(
            f"a load case needs {FORCES} and either nodes or points (got {keys})"
        )
    forces = _rows(content[FORCES], FORCES)
    if places == ["points"]:
        nodes, forces = _snapped(
            _rows(content["points"], "points"), forces, mesh, snap_mm
        )
    else:
        nodes = _whole_numbers(content["nodes"])
    case = LoadCase(nodes, forces)
    case.check_against(mesh, np.empty(0, dtype=np.int64))
    return case


def _growth(content: Any, mesh: TetMesh) -> tuple[VolumeGrowth, ...]:
    if not isinstance(content, dict) or GROWTH not in content:
        return ()
    rows = content[GROWTH]
    if not isinstance(rows, list) or not rows:
        raise InputError(f"{GROWTH} must be a list of one object or more (got {rows})")
    return tuple(_rule(row).on(mesh) for row in rows)


def _rule(row: Any) -> GrowthIn:
    hints = {field.name: field.type for field in fields(GrowthIn)}
    if not isinstance(row, dict) or not set(row) <= set(hints):
        raise InputError(f"{GROWTH} must be objects of {', '.join(hints)} (got {row})")
    for name, value in row.items():
        number = hints[name] is float
        # bool passes for a number in Python, but true is no volume
        if not isinstance(value, (int, float) if number else str) or value is True:
            kind = "a number" if number else "a name"
            raise InputError(f"{name} of {GROWTH} must be {kind} (got {value!r})")
    if "volume_ratio" not in row:
        raise InputError(f"{GROWTH} needs volume_ratio: 1.05 swells by 5 %")
    return GrowthIn(**row)


def _snapped(
    points: FloatArray,
    forces: FloatArray,
    mesh: TetMesh,
    snap_mm: float,
) -> tuple[IntArray, FloatArray]:
    """Return the nearest surface nodes and the sum of the forces on each."""
    from scipy.spatial import cKDTree

    if len(points) != len(forces):
        raise InputError(
            f"{FORCES} must have one force a point (got {len(forces)} forces for "
            f"{len(points)} points)"
        )
    surface = boundary_points(mesh)
    distance, nearest = cKDTree(mesh.points[surface]).query(points)
    far = int(distance.argmax())
    if distance[far] > snap_mm:
        raise InputError(
            f"point {points[far].tolist()} must lie within {snap_mm:g} mm of a surface "
            f"node (the nearest is {distance[far]:.1f} mm away): check axes and units"
        )
    nodes, index = np.unique(surface[nearest], return_inverse=True)
    total = np.zeros((len(nodes), 3))
    np.add.at(total, index, forces)
    return nodes, total


def _whole_numbers(value: Any) -> IntArray:
    # bool passes for int in Python, but true is no node
    if not isinstance(value, list) or not all(type(node) is int for node in value):
        raise InputError("nodes must be a list of whole numbers")
    return np.array(value, dtype=np.int64)


def _rows(value: Any, name: str) -> FloatArray:
    try:
        rows = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        rows = np.full(1, np.nan)
    if rows.size == 0:
        raise InputError(
            f"{name} must be a list of triples of finite numbers, one or more"
        )
    if rows.ndim != 2 or rows.shape[1] != 3 or not np.isfinite(rows).all():
        raise InputError(f"{name} must be a list of triples of finite numbers")
    return rows

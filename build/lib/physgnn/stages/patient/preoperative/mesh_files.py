"""From another program's tetrahedral mesh to one of ours."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry import Rule, TetMesh, check_quality, select
from physgnn.geometry.plausibility import check_millimetres, check_volume_ml
from physgnn.geometry.regions import REGIONS
from physgnn.geometry.segmentation.label_report import MOST_UNUSED
from physgnn.geometry.segmentation.labels.tissue_names import (
    DEFAULT,
    listed,
    tissues_by_name,
)
from physgnn.geometry.tetmesh import signed_volumes, without_unused_points
from physgnn.io.meshes.tetrahedra import MESH_SUFFIXES, Tetrahedra, read_tetrahedra
from physgnn.io.untrusted.input_errors import reading
from physgnn.progress import Log, no_log

OURS = "region"


def is_mesh_file(path: str | Path) -> bool:
    """Whether a name is one of a mesh, not of an image."""
    return Path(path).suffix.lower() in MESH_SUFFIXES


def mesh_of_file(
    path: str | Path,
    labels: str = DEFAULT,
    *,
    ignore_labels: bool = False,
    any_size: bool = False,
    quality_floor: float | None = None,
    rules: Mapping[str, Rule] | None = None,
    log: Log = no_log,
) -> TetMesh:
    """Take over a tetrahedral mesh with its regions and sets of points.

    Parameters
    ----------
    path : path
        See `physgnn.io.meshes.tetrahedra.read_tetrahedra`; in mm.
    labels : str
        Which region is which tissue: by the names of groups, or such as
        ``"brain=1,tumour=2"``.
    ignore_labels : bool
        Whether cells of other regions may be left out.
    any_size : bool
        Whether the brain may have less than 50 or more than 2500 ml.
    quality_floor : float, optional
        See `physgnn.geometry.check_quality`.
    rules : mapping of str to rule
        Point sets by name, beside those of the file.
    log : callable
        Called with the table of regions, what was repaired, and size and quality.

    Raises
    ------
    InputError
        If the file or the labels cannot be used, a cell has no volume, or the mesh has
        no brain's size.
    """
    with reading(path, "a mesh of tetrahedra"):
        found = read_tetrahedra(path, log=log)
        check_millimetres(found.points[np.unique(found.cells)], str(path))
        ml = signed_volumes(found.points, found.cells) / 1000.0
        region = _regions(found, labels, ml, log, ignore_labels=ignore_labels)
        kept = region >= 0
        for line in check_volume_ml(
            1000.0 * float(ml[kept].sum()), str(path), any_size=any_size
        ):
            log(line)
        mesh, used = without_unused_points(
            found.points,
            found.cells[kept],
            region[kept].astype(np.int32),
            point_sets=found.point_sets,
        )
    if len(used) < len(found.points):
        log(f"points of no cell: {len(found.points) - len(used)}, dropped")
    floor = {} if quality_floor is None else {"floor": quality_floor}
    log(str(check_quality(mesh, **floor)))
    mesh = mesh.with_point_sets(
        **{name: select(mesh, rule) for name, rule in (rules or {}).items()}
    )
    for name, ids in mesh.point_sets.items():
        log(f"point set '{name}': {len(ids)} points")
    return mesh


def _regions(
    found: Tetrahedra, labels: str, ml: FloatArray, log: Log, *, ignore_labels: bool
) -> IntArray:
    """Return the region of every cell, -1 for what is left out; log the table."""
    present = [int(n) for n in np.unique(found.numbers)]
    tissues: dict[str, tuple[int, ...]]
    if labels == DEFAULT and found.array == OURS and max(present) < len(REGIONS):
        tissues = {REGIONS[n]: (n,) for n in present if n >= 0}
    else:
        tissues = tissues_by_name(labels, present, found.names)
    region = np.full(len(found.cells), -1, np.int64)
    for tissue, numbers in tissues.items():
        region[np.isin(found.numbers, numbers)] = REGIONS.index(tissue)
    for number in present:
        mine = found.numbers == number
        k = int(region[mine][0])
        name = f" '{found.names[number]}'" if number in found.names else ""
        log(
            f"region {number}{name} → {REGIONS[k] if k >= 0 else 'not used'}: "
            f"{mine.sum()} cells, {ml[mine].sum():.4g} ml"
        )
    left_out = float(ml[region < 0].sum())
    if left_out > MOST_UNUSED * float(ml.sum()) and not ignore_labels:
        unused = np.unique(found.numbers[region < 0]).tolist()
        raise InputError(
            f"every region must be named (not used: {listed(unused, found.names)}, "
            f"{left_out:.3g} ml): name them, such as --labels "
            f"brain={present[0]},tumour={unused[0]}, or pass --ignore-labels "
            "(ignore_labels=True) if they are not to be meshed"
        )
    if not (region == 0).any():
        raise InputError(f"no cell is brain (it has {listed(present, found.names)})")
    return region

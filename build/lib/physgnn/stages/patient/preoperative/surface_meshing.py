"""From checked surfaces, whatever they were made of, to a mesh with point sets."""

from collections.abc import Mapping, Sequence
from typing import Any

from physgnn.geometry import (
    Rule,
    Surface,
    TetMesh,
    check_nested,
    check_quality,
    check_surface,
    select,
    tetrahedralize,
)
from physgnn.geometry.segmentation.remeshing import remeshed, too_fine
from physgnn.progress import Log, no_log


def mesh_surfaces(
    brain: Surface,
    tumours: Sequence[Surface] = (),
    *,
    rules: Mapping[str, Rule] | None = None,
    quality_floor: float | None = None,
    names: Sequence[str] = (),
    keep_surface: bool = True,
    mesher: str | None = None,
    log: Log = no_log,
    **size: Any,
) -> TetMesh:
    """Check surfaces, fill them with tetrahedra, and name the point sets.

    Parameters
    ----------
    brain, tumours : Surface
        In mm; small faults are repaired, and logged.
    rules : mapping of str to rule
        Point sets by name.
    quality_floor : float, optional
        See `physgnn.geometry.check_quality`.
    names : sequence of str
        What messages call the surfaces inside the brain; by default tumours.
    keep_surface : bool
        Whether surfaces finer than ``target_points`` needs are kept all the same.
    mesher : str, optional
        See `physgnn.geometry.tetrahedralize`.
    log : callable
        Called with what was repaired, and the mesh's size and quality.
    **size
        ``max_volume_mm3`` or ``target_points``; by default the published rule.

    Raises
    ------
    InputError
        If a surface cannot be meshed, a rule selects nothing, or a cell is too flat.
    """
    checked = []
    called = names or [f"tumour {i + 1}" for i in range(len(tumours))]
    for name, surface in zip(["brain", *called], [brain, *tumours], strict=True):
        surface, repaired = check_surface(surface, name)
        checked.append(surface)
        for line in repaired:
            log(line)
    check_nested(checked[0], checked[1:], names)
    target = size.get("target_points")
    if target is not None and not keep_surface and too_fine(checked[0], target):
        outer, inner = remeshed(checked[0], checked[1:], target, names=called, log=log)
        checked = [outer, *inner]
    mesh = tetrahedralize(checked[0], checked[1:], mesher=mesher, log=log, **size)
    floor = {} if quality_floor is None else {"floor": quality_floor}
    log(str(check_quality(mesh, **floor)))
    sets = {name: select(mesh, rule) for name, rule in (rules or {}).items()}
    for name, ids in sets.items():
        log(f"point set '{name}': {len(ids)} points")
    return mesh.with_point_sets(**sets)

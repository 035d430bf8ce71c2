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
from physgnn.progress import Log, no_log


def mesh_surfaces(
    brain: Surface,
    tumours: Sequence[Surface] = (),
    *,
    rules: Mapping[str, Rule] | None = None,
    quality_floor: float | None = None,
    names: Sequence[str] = (),
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
    default = [f"tumour {i + 1}" for i in range(len(tumours))]
    for i, surface in enumerate([brain, *tumours]):
        name = ["brain", *(names or default)][i]
        surface, repaired = check_surface(surface, name)
        checked.append(surface)
        for line in repaired:
            log(line)
    check_nested(checked[0], checked[1:])
    mesh = tetrahedralize(checked[0], checked[1:], log=log, **size)
    floor = {} if quality_floor is None else {"floor": quality_floor}
    log(str(check_quality(mesh, **floor)))
    sets = {name: select(mesh, rule) for name, rule in (rules or {}).items()}
    for name, ids in sets.items():
        log(f"point set '{name}': {len(ids)} points")
    return mesh.with_point_sets(**sets)

"""From surfaces to a mesh with its point sets."""

from collections.abc import Callable, Mapping, Sequence
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

Log = Callable[[str], None]


def mesh_surfaces(
    brain: Surface,
    tumours: Sequence[Surface] = (),
    *,
    rules: Mapping[str, Rule] | None = None,
    quality_floor: float | None = None,
    log: Log = lambda _: None,
    **size: Any,
) -> TetMesh:
    """Check surfaces, fill them with tetrahedra, and name the point sets.

    Parameters
    ----------
    brain, tumours : Surface
        In mm; small faults are mended, and said.
    rules : mapping of str to rule
        Point sets by name.
    quality_floor : float, optional
        See `physgnn.geometry.check_quality`.
    log : callable
        Told what was mended, and the mesh's size and quality.
    **size
        ``max_volume_mm3`` or ``target_points``; by default the published rule.

    Raises
    ------
    InputError
        If a surface cannot be meshed, a rule selects nothing, or a cell is too flat.
    """
    checked = []
    for i, surface in enumerate([brain, *tumours]):
        name = "brain" if i == 0 else f"tumour {i}"
        surface, mended = check_surface(surface, name)
        checked.append(surface)
        for line in mended:
            log(line)
    check_nested(checked[0], checked[1:])
    mesh = tetrahedralize(checked[0], checked[1:], log=log, **size)
    floor = {} if quality_floor is None else {"floor": quality_floor}
    log(str(check_quality(mesh, **floor)))
    sets = {name: select(mesh, rule) for name, rule in (rules or {}).items()}
    for name, ids in sets.items():
        log(f"point set '{name}': {len(ids)} points")
    return mesh.with_point_sets(**sets)

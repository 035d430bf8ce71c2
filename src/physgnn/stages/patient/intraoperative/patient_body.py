"""Whose brain is registered: the body, how it is held, and what was taken out."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from physgnn.dataset.membranes import Membranes
from physgnn.errors import InputError
from physgnn.geometry import TetMesh
from physgnn.geometry.regions import REGIONS
from physgnn.io import read_mesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.materials.tissues import TISSUES
from physgnn.progress import Log, no_log
from physgnn.registration.removed_region import Resected, resected

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.registration.registrar import Registrar

DEFAULT_MATERIALS: Mapping[int, Material] = {
    region: TISSUES[name].material for region, name in enumerate(REGIONS)
}


@dataclass(frozen=True)
class HowItIsHeld:
    """What is known of a patient's brain before anything is measured.

    Attributes
    ----------
    skull : str
        A row of `physgnn.registration.skull.SUPPORTS`.
    remove : str or None
        The region that was resected.
    causes : str or None
        Rows of `physgnn.registration.causes.CAUSES`, with commas; "none" for none, None
        for all that the body has the sets for.
    membranes, materials : path or None
        TOML with a table ``[membranes]``, and with ``[materials.<region>]``.
    """

    skull: str = "fixed"
    remove: str | None = None
    causes: str | None = None
    membranes: str | Path | None = None
    materials: str | Path | None = None

    @property
    def named_causes(self) -> tuple[str, ...] | None:
        """The causes one by one; None takes all there are."""
        if self.causes is None:
            return None
        names = self.causes.split(",")
        return () if self.causes == "none" else tuple(name.strip() for name in names)


@dataclass(frozen=True, eq=False)
class PatientBody:
    """Whose brain is registered.

    Attributes
    ----------
    body : Body
        At rest, without what was removed.
    make : callable
        Returns the registrar; it takes seconds, so call it when the first state needs
        it.
    told : mapping
        What else the displacement depends on, for its digest.
    resection : Resected or None
        What was removed.
    """

    body: Body
    make: Callable[[], "Registrar"]
    told: Mapping[str, Any]
    resection: Resected | None = None


def patient_of(
    mesh: str | Path, held: HowItIsHeld, *, log: Log = no_log
) -> PatientBody:
    """Return the patient of a mesh file; by default of the published tissues.

    The log gets a line if the mesh seems to be in another unit than mm.

    Raises
    ------
    InputError
        If a file cannot be used, or what is removed is not there.
    """
    case, resection = read_mesh(mesh, log=log), None
    if held.remove is not None:
        resection = resected(case, held.remove)
        case = resection.remaining
    given, membranes = _given(held)
    body = Body(case, {**DEFAULT_MATERIALS, **given})
    causes = held.named_causes

    def make() -> "Registrar":
        from physgnn.registration.registrar import Registrar

        return Registrar(body, skull=held.skull, causes=causes, membranes=membranes)

    told = {"skull": held.skull, "causes": causes, "membranes": repr(membranes)}
    return PatientBody(body, make, told, resection)


def _given(held: HowItIsHeld) -> tuple[Mapping[int, Material], Membranes]:
    """Return materials and membranes as files have them; most often there is none."""
    if held.materials is None and held.membranes is None:
        return {}, Membranes()
    from physgnn.config import read_materials, read_membranes

    given = {} if held.materials is None else read_materials(held.materials)
    return given, read_membranes(held.membranes)


def ready_patient(registrar: "Registrar") -> PatientBody:
    """Return the patient of a registrar that is ready."""
    told = {
        "skull": registrar.skull,
        "causes": registrar.causes,
        "membranes": repr(registrar.membranes),
    }
    return PatientBody(registrar.body, lambda: registrar, told)


def ready_registrar(
    mesh: str | Path,
    *,
    skull: str = "fixed",
    causes: str | None = None,
    membranes: str | Path | None = None,
    materials: str | Path | None = None,
) -> "Registrar":
    """Return what `physgnn.register` takes as `registrar`, to register many times.

    Load modes and factors take seconds; they are the same for every measurement.

    Parameters
    ----------
    mesh, skull, causes, membranes, materials
        As of `physgnn.register`.

    Raises
    ------
    InputError
        If a file cannot be used, or the fixed points do not hold the body.
    """
    held = HowItIsHeld(skull, None, causes, membranes, materials)
    return patient_of(mesh, held).make()


def checked_registrar(
    registrar: "Registrar", mesh: str | Path, held: HowItIsHeld
) -> "Registrar":
    """Return a registrar that was made ready for this mesh.

    Raises
    ------
    InputError
        If it is of another mesh, or options are given that it has its own of.
    """
    own, usual = asdict(held), asdict(HowItIsHeld())
    given = [name for name, value in own.items() if value != usual[name]]
    if given:
        raise InputError(
            f"a registrar has {' and '.join(given)} of its own: leave them out"
        )
    named, its = read_mesh(mesh), registrar.body.mesh
    if not _same(named, its):
        raise InputError(
            f"{mesh}: the registrar must be of this mesh (it is of another, of "
            f"{its.n_points} points): make one by ready_registrar"
        )
    return registrar


def _same(one: TetMesh, other: TetMesh) -> bool:
    return (
        np.array_equal(one.points, other.points)
        and np.array_equal(one.cells, other.cells)
        and np.array_equal(one.region, other.region)
        and set(_fixed(one)) == set(_fixed(other))
    )


def _fixed(mesh: TetMesh) -> list[int]:
    return [int(i) for i in mesh.point_sets.get("fixed", ())]

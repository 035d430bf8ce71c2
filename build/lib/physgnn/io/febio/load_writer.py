"""Loads as FEBio 4 writes them; every load follows the one load curve.

| load | in the model |
|---|---|
| nodal forces | one nodal load a component, with a map of its values |
| `Gravity` without fluid | body force: **minus** the acceleration, and a density |
| `SurfacePressure` | surface load ``pressure`` that follows the surface |
| `PrescribedDisplacement` | one prescribed displacement a component |
| growth | a material of its own: `physgnn.io.febio.growth` |

Source: FEBio User Manual 4, sections 3.11 (Boundary) and 3.12 (Loads). Units are mm, N,
MPa, s, and so t/mm³ for density. FEBio 4.11 ran models of each kind; that a prescribed
displacement may be a map, as forces are, is from the manual.
"""

from collections.abc import Mapping, Sequence
from xml.etree import ElementTree as ET

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.io.febio.elements import AXES, CURVE, add, listed, moved_point
from physgnn.io.febio.growth import check_growth
from physgnn.mechanics.loads.gravity import STANDARD_GRAVITY, Gravity
from physgnn.mechanics.loads.paths import Load, LoadPath
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.loads.pressure import SurfacePressure
from physgnn.mechanics.loads.springs import Springs

GRAVITY_MM_S2 = 1e3 * STANDARD_GRAVITY
KG_M3_TO_T_MM3 = -12  # powers of ten
PA_TO_MPA = -6
Sections = Mapping[str, ET.Element]


def check_writable(loads: Sequence[Load]) -> None:
    """Raise InputError if FEBio has no such load: buoyancy by a level, springs."""
    check_growth(loads)
    for load in loads:
        if isinstance(load, Gravity) and load.fluid_level_mm is not None:
            raise InputError(
                "FEBio has no load for gravity with a level of fluid: leave "
                "fluid_level_mm out, or solve without FEBio"
            )
        if isinstance(load, Springs):
            raise InputError(
                "models for FEBio hold no elastic membranes: hold them or leave them "
                "out, or solve without FEBio"
            )


def follows_surface(path: LoadPath) -> bool:
    """Return whether a load turns with the surface: the stiffness is unsymmetric."""
    return any(isinstance(load, SurfacePressure) for load in path.more)


def density_of(path: LoadPath) -> float | None:
    """Return the density that the materials shall have, kg/m³; None without gravity.

    It is the first gravity's. FEBio multiplies every body force by it, so that other
    gravities are written with an acceleration in proportion to their own density.
    """
    return next((m.density_kg_m3 for m in path.more if isinstance(m, Gravity)), None)


def add_loads(sections: Sections, path: LoadPath) -> None:
    """Write a path's loads into the sections Mesh, MeshData, Boundary and Loads.

    Raises
    ------
    InputError
        If FEBio has no such load.
    """
    check_writable(path.more)
    if len(path.nodes):
        add(
            sections["Mesh"],
            "NodeSet",
            listed((path.nodes + 1).tolist()),
            name="loaded",
        )
        _add_forces(sections, path.forces)
    density = density_of(path)
    for number, load in enumerate(path.more, 1):
        match load:
            case Gravity():
                assert density is not None
                ratio = load.density_kg_m3 / density
                _add_gravity(sections, load, f"gravity-{number}", ratio)
            case SurfacePressure():
                _add_pressure(sections, load, f"pressure-{number}")
            case PrescribedDisplacement():
                _add_prescribed(sections, load, f"prescribed-{number}")


def _add_forces(sections: Sections, forces: FloatArray) -> None:
    for axis, values in zip(AXES, forces.T, strict=True):
        name = f"force-{axis}"
        _add_map(sections, name, "loaded", values)
        load = add(
            sections["Loads"],
            "nodal_load",
            name=name,
            type="nodal_load",
            node_set="loaded",
        )
        add(load, "dof", axis)
        add(load, "scale", name, lc=CURVE, type="map")


def _add_gravity(sections: Sections, load: Gravity, name: str, ratio: float) -> None:
    body_load = add(sections["Loads"], "body_load", name=name, type="body force")
    minus_acceleration = (
        -GRAVITY_MM_S2 * ratio * np.array(load.direction) + 0.0
    )  # no −0
    add(body_load, "force", listed(minus_acceleration.tolist()), lc=CURVE)


def _add_pressure(sections: Sections, load: SurfacePressure, name: str) -> None:
    surface = add(sections["Mesh"], "Surface", name=name)
    for number, face in enumerate((load.faces + 1).tolist(), 1):
        add(surface, "tri3", listed(face), id=str(number))
    pushes = add(
        sections["Loads"], "surface_load", name=name, type="pressure", surface=name
    )
    add(pushes, "pressure", moved_point(load.pressure_pa, PA_TO_MPA), lc=CURVE)
    add(pushes, "linear", "0")  # 1 would keep the direction of rest
    add(pushes, "symmetric_stiffness", "0")


def _add_prescribed(
    sections: Sections, load: PrescribedDisplacement, name: str
) -> None:
    add(sections["Mesh"], "NodeSet", listed((load.nodes + 1).tolist()), name=name)
    for axis, values in zip(AXES, load.displacement.T, strict=True):
        bc = add(
            sections["Boundary"],
            "bc",
            name=f"{name}-{axis}",
            type="prescribed displacement",
            node_set=name,
        )
        add(bc, "dof", axis)
        if (values == values[0]).all():
            add(bc, "value", repr(float(values[0])), lc=CURVE)
        else:
            _add_map(sections, f"{name}-{axis}", name, values)
            add(bc, "value", f"{name}-{axis}", lc=CURVE, type="map")
        add(bc, "relative", "0")


def _add_map(sections: Sections, name: str, node_set: str, values: FloatArray) -> None:
    """Add the values of a node set; ``lid`` counts within it."""
    data = add(
        sections["MeshData"],
        "NodeData",
        name=name,
        node_set=node_set,
        data_type="scalar",
    )
    for i, value in enumerate(values.tolist(), 1):
        add(data, "node", repr(value), lid=str(i))

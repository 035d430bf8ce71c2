"""A load path as a FEBio model (.feb 4.0) that FEBio runs as it is.

Time counts levels: step i ends at time i, and a load curve gives the load factor
there. FEBio prints the displacement of all points after every step to a log of its
own, which `physgnn.io.febio.log` reads. Source of the format: FEBio User Manual 4,
chapter 3. Units are mm, N, MPa.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.febio.elements import AXES, CURVE, add, listed, moved_point
from physgnn.io.febio.growth import FebioPart, curves_of, grown_material, parts_of
from physgnn.io.febio.load_writer import (
    KG_M3_TO_T_MM3,
    add_loads,
    density_of,
    follows_surface,
)
from physgnn.io.febio.materials import febio_material
from physgnn.io.integrity.atomic import write_whole
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.external_force import Loading
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import Material
from physgnn.mechanics.support import check_held

DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>\n'
SECTIONS = (
    *("Module", "Control", "Material", "Mesh", "MeshDomains", "MeshData"),
    *("Boundary", "Loads", "LoadData"),
)
"""In the order in which FEBio reads them; the output comes last."""

# Tight. FEBio compares the square of the residual with rtol, and min_residual is an
# absolute floor under which it takes any state for equilibrium: at forces of
# millinewtons it must be 0.
TOLERANCES = {
    "max_refs": "50",
    "dtol": "1e-06",
    "etol": "1e-10",
    "rtol": "1e-16",
    "min_residual": "0",
}


def write_febio(
    path: str | Path,
    body: Body,
    load_path: LoadPath,
) -> None:
    """Write a model whose steps are the levels of a load path.

    Parameters
    ----------
    path : path
        Ends in .feb; FEBio writes its log of displacements beside it, see `log_of`.
    body : Body
        Its mesh becomes one part a region; its element is not written.
    load_path : LoadPath
        Nodal forces and other loads; neither forces nor prescribed displacements may
        be on fixed points.

    Raises
    ------
    InputError
        If the name does not end in .feb, the load does not fit the body or leaves a
        part of it free to move, or FEBio has no such load.
    """
    path = Path(path)
    if path.suffix.lower() != ".feb":
        raise InputError(
            f"{path}: a FEBio model is written as .feb (got '{path.suffix}')"
        )
    loading = Loading(body.mesh, load_path, body.fixed)  # refuses what does not fit
    check_held(body.mesh, np.union1d(body.fixed, loading.held))
    root = _model(body, load_path)
    _add_output(root, log_of(path).name)
    ET.indent(root)
    # FEBio has a reader of its own: it gets the first line, and the ends of empty
    # elements, in the very form that it writes itself.
    text = ET.tostring(root, encoding="unicode").replace(" />", "/>")
    write_whole(path, f"{DECLARATION}{text}\n")


def log_of(model: Path) -> Path:
    """Return where FEBio logs the displacements of a model written here."""
    return model.with_name(f"{model.stem}-displacement.log")


def _model(body: Body, load_path: LoadPath) -> ET.Element:
    """Return the model, all but what it puts out."""
    mesh = body.mesh
    root = ET.Element("febio_spec", version="4.0")
    sections = {name: add(root, name) for name in SECTIONS}
    parts = parts_of(mesh, load_path)
    curves = curves_of(parts)
    sections["Module"].set("type", "solid")
    _add_control(sections["Control"], load_path)
    for number, part in enumerate(parts, 1):
        material = add(sections["Material"], "material", id=str(number), name=part.name)
        curve = curves.get(part.name)
        _fill_material(material, part, body.materials, density_of(load_path), curve)
        add(sections["MeshDomains"], "SolidDomain", name=part.name, mat=part.name)
    _add_mesh(sections["Mesh"], mesh, parts)
    add(sections["Mesh"], "NodeSet", listed((body.fixed + 1).tolist()), name="fixed")
    _add_fixed(sections["Boundary"])
    add_loads(sections, load_path)
    _add_load_curve(sections["LoadData"], CURVE, [0.0, *load_path.load_factors])
    for part in parts:
        if part.stretch is not None:
            curve = curves[part.name]
            _add_load_curve(sections["LoadData"], curve, [1.0, *part.stretch])
    return root


def _add_control(section: ET.Element, load_path: LoadPath) -> None:
    """Add full Newton: a quasi-Newton method that makes no updates."""
    add(section, "analysis", "STATIC")
    add(section, "time_steps", str(load_path.n_levels))
    add(section, "step_size", "1")
    solver = add(section, "solver", type="solid")
    kind = "non-symmetric" if follows_surface(load_path) else "symmetric"
    add(solver, "symmetric_stiffness", kind)
    for name, value in TOLERANCES.items():
        add(solver, name, value)
    add(add(solver, "qn_method", type="BFGS"), "max_ups", "0")


def _fill_material(
    element: ET.Element,
    part: FebioPart,
    materials: Mapping[int, Material],
    density_kg_m3: float | None,
    curve: str | None,
) -> None:
    if part.region not in materials:
        raise InputError(f"region {part.region} has no material: name one for it")
    material = materials[part.region]
    kind, values = febio_material(material)
    element.set("type", kind)
    if curve is not None:
        element = grown_material(material, element, curve)
    if density_kg_m3 is not None:
        add(element, "density", moved_point(density_kg_m3, KG_M3_TO_T_MM3))
    for tag, value in values.items():
        add(element, tag, value)


def _add_mesh(section: ET.Element, mesh: TetMesh, parts: Sequence[FebioPart]) -> None:
    nodes = add(section, "Nodes", name="all")
    for i, point in enumerate(mesh.points.tolist(), 1):
        add(nodes, "node", listed(point), id=str(i))
    corners = mesh.cells + 1
    for part in parts:
        elements = add(section, "Elements", type="tet4", name=part.name)
        for cell in part.cells.tolist():
            add(elements, "elem", listed(corners[cell].tolist()), id=str(cell + 1))


def _add_fixed(section: ET.Element) -> None:
    bc = add(section, "bc", name="fixed", type="zero displacement", node_set="fixed")
    for axis in AXES:
        add(bc, f"{axis}_dof", "1")


def _add_load_curve(section: ET.Element, name: str, values: list[float]) -> None:
    """Add a curve with one point a level, the first before all loads."""
    curve = add(section, "load_controller", id=name, type="loadcurve")
    add(curve, "interpolate", "LINEAR")
    add(curve, "extend", "CONSTANT")
    points = add(curve, "points")
    for time, value in enumerate(values):
        add(points, "pt", f"{time},{float(value)!r}")


def _add_output(root: ET.Element, log: str) -> None:
    section = add(root, "Output")
    plot = add(section, "plotfile", type="febio")
    add(plot, "var", type="displacement")
    logfile = add(section, "logfile")
    add(logfile, "node_data", data="ux;uy;uz", file=log)

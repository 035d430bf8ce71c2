"""Reads a FEBio model (.feb 4.0) of the kind we can solve and learn from.

That is: linear tetrahedra, our materials, points held in all directions, and loads of
ours (`physgnn.io.febio.load_reader`) that share one load curve. Anything else in the
file is named and refused, since leaving it out would change the solution.
"""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.febio.elements import AXES, floats
from physgnn.io.febio.growth import (
    GROWN,
    REGION_PREFIX,
    GrownPart,
    elastic_of,
    is_grown,
)
from physgnn.io.febio.load_reader import PRESCRIBED, LoadReader
from physgnn.io.febio.log import read_febio_log
from physgnn.io.febio.materials import material_of
from physgnn.io.simulation import Simulation
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.xml_tree import read_xml
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import Material

MOST_STEPS = 100_000
SECTIONS = (
    *("Module", "Control", "Globals", "Material", "Mesh", "MeshDomains", "MeshData"),
    *("Boundary", "Loads", "LoadData", "Output"),
)


@dataclass(frozen=True, eq=False)
class FebioModel:
    """What a .feb file asks.

    Attributes
    ----------
    mesh : TetMesh
        With its node sets; points and cells in the order of their ids.
    materials : dict of region to Material
    fixed : (n_fixed,) integer array
    load_path : LoadPath
        One level a time step.
    times : (n_levels,) array
        When the steps end.
    node_ids : (n_points,) integer array
        FEBio's id of every point.
    log : path or None
        Where FEBio logs ``ux;uy;uz`` of all nodes.
    """

    mesh: TetMesh
    materials: dict[int, Material]
    fixed: IntArray
    load_path: LoadPath
    times: FloatArray
    node_ids: IntArray
    log: Path | None


def read_febio(path: str | Path) -> FebioModel:
    """Read a model.

    Raises
    ------
    InputError
        If the file is no .feb 4.0, or holds something we cannot represent.
    """
    path = Path(path)
    with reading(path, "a FEBio model"):
        root = read_xml(path, "a FEBio model")
        if root.tag != "febio_spec" or root.get("version") != "4.0":
            raise InputError(
                f"expected febio_spec 4.0 (got {root.tag} {root.get('version')}): "
                "export it from FEBio Studio as version 4"
            )
        _check_sections(root)
        return _Reader(root).model(path)


def read_febio_results(path: Path) -> list[Simulation]:
    """Read a model, and its log when the solution is asked for.

    Raises
    ------
    InputError
        As `read_febio`, or if the model asks for no log of displacements.
    """
    model = read_febio(path)
    if model.log is None:
        raise InputError(
            f'{path}: needs <node_data data="ux;uy;uz" file=…> under Output/logfile, '
            "and FEBio run with it"
        )
    read = partial(
        read_febio_log,
        model.log,
        model.load_path,
        times=model.times,
        node_ids=model.node_ids,
    )
    asked = (model.mesh, model.fixed, model.load_path, model.materials)
    return [Simulation(str(path), *asked, read)]


def _check_sections(root: ET.Element) -> None:
    """Raise InputError if there is contact, a rigid body, a second step, …."""
    for section in root:
        if section.tag not in SECTIONS and len(section):
            raise InputError(
                f"section <{section.tag}> is nothing we can represent: take it out, or "
                "import the results as arrays"
            )


class _Reader:
    """One pass over one file; keeps what later sections refer to."""

    def __init__(self, root: ET.Element) -> None:
        self.root = root
        nodes = root.findall("Mesh/Nodes/node")
        ids = np.array([int(node.attrib["id"]) for node in nodes])
        order = np.argsort(ids)
        self.node_ids: IntArray = ids[order]
        if (np.diff(self.node_ids) == 0).any():
            raise InputError("two nodes have the same id")
        points = np.array([floats(node) for node in nodes]).reshape(-1, 3)
        self.points: FloatArray = points[order]
        self.sets = {
            element.attrib["name"]: self._index(floats(element))
            for element in root.findall("Mesh/NodeSet")
        }
        self.loads = LoadReader(root, self.sets, self._index, len(points))

    def model(self, path: Path) -> FebioModel:
        mesh, materials, grown = self._body()
        steps = int(self._text("Control/time_steps"))
        if not 0 < steps <= MOST_STEPS:
            raise InputError(f"time_steps must be in 1…{MOST_STEPS} (got {steps})")
        times = float(self._text("Control/step_size")) * np.arange(1.0, steps + 1)
        log = self.root.find("Output/logfile/node_data[@data='ux;uy;uz']")
        name = None if log is None else log.get("file")
        return FebioModel(
            mesh=mesh,
            materials=materials,
            fixed=self._fixed(),
            load_path=self.loads.path(times, grown),
            times=times,
            node_ids=self.node_ids,
            log=None if name is None else path.parent / name,
        )

    def _body(self) -> tuple[TetMesh, dict[int, Material], list[GrownPart]]:
        named = {m.attrib["name"]: m for m in self.root.findall("Material/material")}
        of_part = {
            domain.attrib["name"]: domain.attrib["mat"]
            for domain in self.root.findall("MeshDomains/SolidDomain")
        }
        materials: dict[int, Material] = {}
        ids, cells, region, part_of, grows = [], [], [], [], {}
        for number, part in enumerate(self.root.findall("Mesh/Elements")):
            name = part.attrib["name"]
            if part.get("type") != "tet4":
                raise InputError(
                    f"part '{name}' must be of tet4 (got {part.get('type')})"
                )
            label = _region(name, number)
            material = named[of_part[name]]
            if is_grown(material):
                material, multiplier, curve = elastic_of(material)
                grows[number] = (name, multiplier, curve)
            materials[label] = material_of(material)
            part_of += [number] * len(part)
            ids += [int(cell.attrib["id"]) for cell in part]
            cells += [floats(cell) for cell in part]
            region += [label] * len(part)
        order = np.argsort(ids)
        corners = self._index(np.array(cells).ravel()).reshape(-1, 4)
        mesh = TetMesh(
            points=self.points,
            cells=corners[order].astype(np.int32),
            region=np.array(region, dtype=np.int32)[order],
            point_sets=self.sets,
        )
        part_of_cell = np.array(part_of)[order]
        grown = [
            GrownPart(name, np.flatnonzero(part_of_cell == number), multiplier, curve)
            for number, (name, multiplier, curve) in grows.items()
        ]
        return mesh, materials, grown

    def _fixed(self) -> IntArray:
        held = []
        for bc in self.root.findall("Boundary/*"):
            if (bc.tag, bc.get("type")) == ("bc", PRESCRIBED):
                continue
            dofs = [bc.findtext(f"{axis}_dof") for axis in AXES]
            if bc.get("type") != "zero displacement" or dofs != ["1", "1", "1"]:
                raise InputError(
                    f"boundary condition '{bc.get('name')}' must be zero displacement "
                    f"in x, y and z, or {PRESCRIBED}"
                )
            held.append(self.loads.set_of(bc))
        if not held:
            raise InputError("no boundary condition holds a node")
        return np.concatenate(held)

    def _index(self, ids: FloatArray | list[float]) -> IntArray:
        index = np.searchsorted(self.node_ids, ids)
        found = self.node_ids[np.minimum(index, len(self.node_ids) - 1)]
        if (found != ids).any():
            missing = int(np.asarray(ids)[found != ids][0])
            raise InputError(f"node {missing} is not among the nodes")
        return index

    def _text(self, where: str) -> str:
        return self.root.findtext(where) or ""


def _region(part: str, number: int) -> int:
    label = part.removeprefix(REGION_PREFIX).split(GROWN)[0]
    return int(label) if part != label and label.isdecimal() else number

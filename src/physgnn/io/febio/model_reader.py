"""Reads a FEBio model (.feb 4.0) of the kind we can solve and learn from.

That is: linear tetrahedra, our materials, points held in all directions, and nodal
forces that share one load curve. Anything else in the file is named and refused, since
leaving it out would change the solution.
"""

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.febio.log import read_febio_log
from physgnn.io.febio.materials import material_of
from physgnn.io.febio.model_writer import AXES, REGION_PREFIX
from physgnn.io.input_errors import reading
from physgnn.io.simulation import Simulation
from physgnn.io.xml_tree import read_xml
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
        points = np.array([_floats(node) for node in nodes]).reshape(-1, 3)
        self.points: FloatArray = points[order]
        self.sets = {
            element.attrib["name"]: self._index(_floats(element))
            for element in root.findall("Mesh/NodeSet")
        }

    def model(self, path: Path) -> FebioModel:
        mesh, materials = self._body()
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
            load_path=self._loads(times),
            times=times,
            node_ids=self.node_ids,
            log=None if name is None else path.parent / name,
        )

    def _body(self) -> tuple[TetMesh, dict[int, Material]]:
        named = {m.attrib["name"]: m for m in self.root.findall("Material/material")}
        of_part = {
            domain.attrib["name"]: domain.attrib["mat"]
            for domain in self.root.findall("MeshDomains/SolidDomain")
        }
        materials, ids, cells, region = {}, [], [], []
        for number, part in enumerate(self.root.findall("Mesh/Elements")):
            name = part.attrib["name"]
            if part.get("type") != "tet4":
                raise InputError(
                    f"part '{name}' must be of tet4 (got {part.get('type')})"
                )
            label = _region(name, number)
            materials[label] = material_of(named[of_part[name]])
            ids += [int(cell.attrib["id"]) for cell in part]
            cells += [_floats(cell) for cell in part]
            region += [label] * len(part)
        order = np.argsort(ids)
        corners = self._index(np.array(cells).ravel()).reshape(-1, 4)
        mesh = TetMesh(
            points=self.points,
            cells=corners[order].astype(np.int32),
            region=np.array(region, dtype=np.int32)[order],
            point_sets=self.sets,
        )
        return mesh, materials

    def _fixed(self) -> IntArray:
        held = []
        for bc in self.root.findall("Boundary/*"):
            dofs = [bc.findtext(f"{axis}_dof") for axis in AXES]
            if bc.get("type") != "zero displacement" or dofs != ["1", "1", "1"]:
                raise InputError(
                    f"boundary condition '{bc.get('name')}' must be zero displacement "
                    "in x, y and z"
                )
            held.append(self._set(bc))
        if not held:
            raise InputError("no boundary condition holds a node")
        return np.concatenate(held)

    def _loads(self, times: FloatArray) -> LoadPath:
        force = np.zeros_like(self.points)
        curves = set()
        for load in self.root.findall("Loads/*"):
            if load.get("type") != "nodal_load":
                raise InputError(
                    f"load '{load.get('name')}' must be nodal_load "
                    f"(got {load.tag} {load.get('type')})"
                )
            scale, dof = load.find("scale"), (load.findtext("dof") or "").strip()
            if scale is None or dof not in tuple(AXES):
                raise InputError(
                    f"load '{load.get('name')}' needs a <scale>, and a <dof> that is "
                    f"x, y or z (got '{dof}')"
                )
            axis = AXES.index(dof)
            np.add.at(force[:, axis], self._set(load), self._values(load, scale))
            curves.add(scale.get("lc"))
        if len(curves) != 1:
            raise InputError(f"loads must share one load curve (got {len(curves)})")
        factors = self._curve(curves.pop() or "", times)
        sets = [self._set(load) for load in self.root.findall("Loads/nodal_load")]
        nodes = np.array(list(dict.fromkeys(np.concatenate(sets).tolist())))
        largest = max(float(factors.max()), 1.0)
        return LoadPath(nodes, force[nodes] * largest, factors / largest)

    def _values(self, load: ET.Element, scale: ET.Element) -> FloatArray:
        text = (scale.text or "").strip()
        if scale.get("type") != "map":
            return np.array(float(text))
        data = self.root.find(f"MeshData/NodeData[@name='{text}']")
        if data is None or data.get("node_set") != load.get("node_set"):
            raise InputError(
                f"load '{load.get('name')}' needs NodeData '{text}' on its set"
            )
        values = np.zeros(len(self._set(load)))
        lids = [int(node.attrib["lid"]) for node in data]
        if sorted(lids) != list(range(1, len(values) + 1)):
            raise InputError(
                f"NodeData '{text}' needs one value for every node of its set, lid 1 "
                f"to {len(values)}"
            )
        values[np.array(lids) - 1] = [float(node.text or "") for node in data]
        return values

    def _curve(self, name: str, times: FloatArray) -> FloatArray:
        points = [
            _floats(point)
            for point in self.root.findall(
                f"LoadData/load_controller[@id='{name}']/points/pt"
            )
        ]
        if not points:
            raise InputError(f"there is no load curve '{name}'")
        time, value = np.array(points).T
        if (np.diff(time) <= 0).any():
            raise InputError(f"the times of load curve '{name}' must increase")
        factors: FloatArray = np.interp(times, time, value)
        return factors

    def _set(self, element: ET.Element) -> IntArray:
        return self.sets[element.attrib["node_set"].removeprefix("@node_list:")]

    def _index(self, ids: FloatArray | list[float]) -> IntArray:
        index = np.searchsorted(self.node_ids, ids)
        found = self.node_ids[np.minimum(index, len(self.node_ids) - 1)]
        if (found != ids).any():
            missing = int(np.asarray(ids)[found != ids][0])
            raise InputError(f"node {missing} is not among the nodes")
        return index

    def _text(self, where: str) -> str:
        return self.root.findtext(where) or ""


def _floats(element: ET.Element) -> list[float]:
    values = [float(value) for value in (element.text or "").split(",")]
    if not all(map(math.isfinite, values)):
        raise InputError(f"<{element.tag}> must hold finite numbers (got {values})")
    return values


def _region(part: str, number: int) -> int:
    label = part.removeprefix(REGION_PREFIX)
    return int(label) if part != label and label.isdecimal() else number

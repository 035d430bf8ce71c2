"""Loads of a FEBio model: the kinds that `physgnn.io.febio.load_writer` lists.

All must share one load curve. What would be another load than ours is refused by name:
pressure that keeps the direction of rest, relative displacements, a body force on a
part of the body, or materials of several densities under a body force.
"""

from collections.abc import Callable, Mapping, Sequence
from xml.etree import ElementTree as ET

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.io.febio.elements import AXES, axis_of, floats, moved_point, named
from physgnn.io.febio.growth import GrownPart, growth_along
from physgnn.io.febio.load_writer import GRAVITY_MM_S2, KG_M3_TO_T_MM3, PA_TO_MPA
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.growth import VolumeGrowth
from physgnn.mechanics.loads.paths import Load, LoadPath
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.loads.pressure import SurfacePressure
from physgnn.mechanics.loads.springs import Springs

FORCE = ("nodal_load", "nodal_load")
GRAVITY = ("body_load", "body force")
PRESSURE = ("surface_load", "pressure")
PRESCRIBED = "prescribed displacement"
# What a load curve does between its points and beyond them unless it says otherwise
# (FEBio User Manual 4, LoadData section).
LINEAR, CONSTANT = "LINEAR", "CONSTANT"

Index = Callable[[list[float]], IntArray]


class LoadReader:
    """The loads of one file; notes which load curves they name.

    Parameters
    ----------
    root : Element
        The whole model.
    sets : mapping of str to integer array
        Points of every node set.
    index : callable
        Turns FEBio's ids of nodes into points.
    n_points : int
    """

    def __init__(
        self,
        root: ET.Element,
        sets: Mapping[str, IntArray],
        index: Index,
        n_points: int,
    ) -> None:
        self.root, self.sets, self.index = root, sets, index
        self._force: FloatArray = np.zeros((n_points, 3))
        self._loaded: dict[int, None] = {}
        self._prescribed: dict[str, dict[str, FloatArray]] = {}
        self._more: list[Load] = []
        self._curves: set[str | None] = set()

    def path(self, times: FloatArray, grown: Sequence[GrownPart] = ()) -> LoadPath:
        """Return the loads with one level a time.

        Parameters
        ----------
        times : (n_levels,) array
            When the steps end.
        grown : sequence of GrownPart
            What swells or contracts.

        Raises
        ------
        InputError
            If a load is none of ours, or they have several load curves or none.
        """
        readers = {
            FORCE: self._read_force,
            GRAVITY: self._read_gravity,
            PRESSURE: self._read_pressure,
        }
        for load in self.root.findall("Loads/*"):
            kind = (load.tag, load.get("type", ""))
            if kind not in readers:
                raise InputError(
                    f"load '{load.get('name')}' must be nodal_load, body_load 'body "
                    f"force' or surface_load 'pressure' (got {' '.join(kind)})"
                )
            readers[kind](load)
        for bc in self.root.findall(f"Boundary/bc[@type='{PRESCRIBED}']"):
            self._read_prescribed(bc)
        self._more += [self._gathered(name) for name in self._prescribed]
        stretches = [one.multiplier * self._curve(one.curve, times) for one in grown]
        if len(self._curves) != 1 and (self._curves or not grown):
            raise InputError(
                f"loads must share one load curve (got {len(self._curves)})"
            )
        if self._curves:
            factors = self._curve(self._curves.pop() or "", times)
        else:
            factors = (stretches[0] ** 3 - 1.0) / (stretches[0][-1] ** 3 - 1.0)
        largest = max(float(factors.max()), 1.0)
        nodes = np.array(list(self._loaded), dtype=np.int64)
        factors = factors / largest
        more = [_scaled(load, largest) for load in self._more]
        for one, stretch in zip(grown, stretches, strict=True):
            more.append(growth_along(one.cells, stretch, factors, one.name))
        return LoadPath(nodes, self._force[nodes] * largest, factors, tuple(more))

    def set_of(self, element: ET.Element) -> IntArray:
        """Return the points of the node set that an element names."""
        return self.sets[element.attrib["node_set"].removeprefix("@node_list:")]

    def _read_force(self, load: ET.Element) -> None:
        axis = AXES.index(axis_of(load))
        nodes = self.set_of(load)
        np.add.at(self._force[:, axis], nodes, self._values(load, "scale"))
        self._loaded |= dict.fromkeys(nodes.tolist())

    def _read_gravity(self, load: ET.Element) -> None:
        name = load.get("name")
        if load.get("elem_set") is not None:
            raise InputError(f"load '{name}' must act on the whole body")
        vector = -np.array(floats(self._scaled_by_curve(load, "force")))
        texts = {m.findtext("density") for m in self.root.findall("Material/material")}
        if len(texts) != 1 or None in texts:
            raise InputError(
                f"load '{name}' needs the same <density> in every material"
            )
        density = float(moved_point((texts.pop() or "").strip(), -KG_M3_TO_T_MM3))
        length = float(np.linalg.norm(vector))
        if vector.shape != (3,) or length == 0:
            raise InputError(f"load '{name}' needs a <force> of three numbers, not 0")
        x, y, z = (vector / length).tolist()
        self._more.append(Gravity((x, y, z), density * (length / GRAVITY_MM_S2)))

    def _read_pressure(self, load: ET.Element) -> None:
        name = load.get("name")
        if (load.findtext("linear") or "0").strip() != "0":
            raise InputError(
                f"load '{name}' must follow the surface: <linear> must be 0"
            )
        surface = named(self.root, "Mesh/Surface", load.get("surface"))
        if surface is None:
            raise InputError(f"load '{name}': no surface '{load.get('surface')}'")
        if any(face.tag != "tri3" for face in surface):
            raise InputError(f"surface '{load.get('surface')}' must be of tri3")
        corners = [corner for face in surface for corner in floats(face)]
        text = (self._scaled_by_curve(load, "pressure").text or "").strip()
        pressure_pa = float(moved_point(text, -PA_TO_MPA))
        faces = self.index(corners).reshape(-1, 3)
        self._more.append(SurfacePressure(faces, pressure_pa))

    def _read_prescribed(self, bc: ET.Element) -> None:
        if (bc.findtext("relative") or "0").strip() != "0":
            raise InputError(
                f"boundary condition '{bc.get('name')}' must count from the rest "
                "state: <relative> must be 0"
            )
        axis = axis_of(bc)
        values = np.broadcast_to(self._values(bc, "value"), len(self.set_of(bc)))
        of_set = self._prescribed.setdefault(bc.attrib["node_set"], {})
        if axis in of_set:
            raise InputError(
                f"node set '{bc.get('node_set')}' has its {axis} prescribed twice"
            )
        of_set[axis] = values

    def _gathered(self, node_set: str) -> Load:
        of_set = self._prescribed[node_set]
        if sorted(of_set) != list(AXES):
            raise InputError(
                f"node set '{node_set}' must have its x, y and z prescribed "
                f"(got {', '.join(of_set)})"
            )
        nodes = self.sets[node_set.removeprefix("@node_list:")]
        columns = [of_set[axis] for axis in AXES]
        return PrescribedDisplacement(nodes, np.stack(columns, axis=1))

    def _scaled_by_curve(self, load: ET.Element, tag: str) -> ET.Element:
        """Return the child that the load curve scales, and note the curve."""
        child = load.find(tag)
        if child is None:
            raise InputError(f"'{load.get('name')}' needs a <{tag}>")
        self._curves.add(child.get("lc"))
        return child

    def _values(self, load: ET.Element, tag: str) -> FloatArray:
        """Return a number, or a number a node of the load's set."""
        child = self._scaled_by_curve(load, tag)
        text = (child.text or "").strip()
        if child.get("type") != "map":
            return np.array(float(text))
        data = named(self.root, "MeshData/NodeData", text)
        if data is None or data.get("node_set") != load.get("node_set"):
            raise InputError(
                f"load '{load.get('name')}' needs NodeData '{text}' on its set"
            )
        values = np.zeros(len(self.set_of(load)))
        for node in data:
            lid = int(node.attrib["lid"])
            if not 1 <= lid <= len(values):
                raise InputError(
                    f"NodeData '{text}': lid must be in 1…{len(values)} (got {lid})"
                )
            values[lid - 1] = float(node.text or "")
        return values

    def _curve(self, name: str, times: FloatArray) -> FloatArray:
        curve = named(self.root, "LoadData/load_controller", name, attribute="id")
        points = [] if curve is None else curve.findall("points/pt")
        if curve is None or not points:
            raise InputError(f"there is no load curve '{name}'")
        time, value = np.array([floats(point) for point in points]).T
        _check_linear(curve, name)
        if (np.diff(time) <= 0).any():
            raise InputError(f"the times of load curve '{name}' must increase")
        extended = (curve.findtext("extend") or CONSTANT).strip()
        beyond = times.min() < time[0] or times.max() > time[-1]
        if beyond and extended.upper() != CONSTANT:
            raise InputError(
                f"load curve '{name}' must reach from the first step to the last, or "
                f"<extend> must be {CONSTANT} (got {extended})"
            )
        factors: FloatArray = np.interp(times, time, value)
        return factors


def _check_linear(curve: ET.Element, name: str) -> None:
    """Raise InputError if FEBio would not join a curve's points by straight lines."""
    between = (curve.findtext("interpolate") or LINEAR).strip()
    if between.upper() != LINEAR:
        raise InputError(
            f"load curve '{name}' must be interpolated linearly: <interpolate> must be "
            f"{LINEAR} (got {between}); give it a point at every step instead"
        )


def _scaled(load: Load, factor: float) -> Load:
    """Return a load that is `factor` times as large at load factor 1."""
    match load:
        case VolumeGrowth():
            return VolumeGrowth(load.cells, 1.0 + factor * (load.volume_ratio - 1.0))
        case Gravity():
            return Gravity(load.direction, load.density_kg_m3 * factor)
        case SurfacePressure():
            return SurfacePressure(load.faces, load.pressure_pa * factor)
        case Springs():
            return Springs(load.nodes, load.stiffness_n_per_mm * factor)
        case PrescribedDisplacement():
            return PrescribedDisplacement(load.nodes, load.displacement * factor)

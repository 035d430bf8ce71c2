"""Tissue that swells or contracts, as FEBio's material "kinematic growth" has it.

A part of its own holds the cells of a region that grow alike. Its material wraps the
region's as <elastic>, and a <growth> of type "volume growth" whose <multiplier> is the
stretch g, F_g = g I; a load curve of its own gives g = θ^⅓ at every step. FEBio takes
only coupled elastic materials there, of ours the neo-Hookean.

Source: FEBio 4's classes FEKinematicGrowth and FEVolumeGrowth. Models with growth have
not been run by FEBio yet.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.febio.elements import CURVE, add
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.growth import VolumeGrowth
from physgnn.mechanics.loads.paths import Load, LoadPath
from physgnn.mechanics.materials import Material, NeoHookean

KINEMATIC, VOLUME = "kinematic growth", "volume growth"
REGION_PREFIX, GROWN = "region-", "-growth-"
MOST_PARTS = 100
# How far a curve's growth may be from proportional to the loads, in volume ratios.
PROPORTIONAL = 1e-9


@dataclass(frozen=True, eq=False)
class FebioPart:
    """Cells of one region that grow alike.

    Attributes
    ----------
    name : str
        ``region-<label>``, with ``-growth-<number>`` where they grow.
    region : int
        Label.
    cells : integer array
        Of the mesh.
    stretch : (n_levels,) array or None
        g at every level.
    """

    name: str
    region: int
    cells: IntArray
    stretch: FloatArray | None


@dataclass(frozen=True, eq=False)
class GrownPart:
    """A part of a model that is read: its cells, and its stretch as a curve has it."""

    name: str
    cells: IntArray
    multiplier: float
    curve: str


def check_growth(loads: Sequence[Load]) -> None:
    """Raise InputError if growth stands beside gravity.

    FEBio's density of tissue that has grown is another than ours.
    """
    kinds = {type(load) for load in loads}
    if {VolumeGrowth, Gravity} <= kinds:
        raise InputError(
            "models for FEBio hold growth or gravity, not both: leave one out, or "
            "solve without FEBio"
        )


def parts_of(mesh: TetMesh, path: LoadPath) -> list[FebioPart]:
    """Divide a mesh into parts: regions, and within them what grows alike.

    Raises
    ------
    InputError
        If there were more than a hundred, as where every cell grows otherwise.
    """
    growth = [load for load in path.more if isinstance(load, VolumeGrowth)]
    ratio = np.ones((path.n_levels, mesh.n_cells))
    for of_level, factor in zip(ratio, path.load_factors.tolist(), strict=True):
        for load in growth:
            load.multiply(of_level, factor)
    rows, part = np.unique(np.vstack([mesh.region, ratio]), axis=1, return_inverse=True)
    if rows.shape[1] > MOST_PARTS:
        raise InputError(
            f"models for FEBio have {MOST_PARTS} parts at most, and this growth makes "
            f"{rows.shape[1]}: give larger groups of cells one volume_ratio"
        )
    found = []
    for number, row in enumerate(rows.T):
        region, grows = int(row[0]), bool((row[1:] != 1.0).any())
        name = f"{REGION_PREFIX}{region}" + (f"{GROWN}{number + 1}" if grows else "")
        cells = np.flatnonzero(part.ravel() == number)
        found.append(
            FebioPart(name, region, cells, np.cbrt(row[1:]) if grows else None)
        )
    return found


def grown_material(material: Material, element: ET.Element, curve: str) -> ET.Element:
    """Turn a <material> into one that grows; return its <elastic>, to be filled.

    Raises
    ------
    InputError
        If FEBio does not let such a material grow.
    """
    if not isinstance(material, NeoHookean):
        raise InputError(
            f"FEBio lets only coupled materials grow, such as '{NeoHookean.law}' (got "
            f"'{material.law}'): take it for the tissue that grows, or leave growth out"
        )
    elastic = add(element, "elastic", type=element.get("type", ""))
    element.set("type", KINEMATIC)
    add(add(element, "growth", type=VOLUME), "multiplier", "1", lc=curve)
    return elastic


def curves_of(parts: Sequence[FebioPart]) -> dict[str, str]:
    """Return the id of the load curve of each part that grows, by the part's name."""
    grow = [part.name for part in parts if part.stretch is not None]
    return {name: str(int(CURVE) + 1 + i) for i, name in enumerate(grow)}


def is_grown(material: ET.Element) -> bool:
    """Return whether a <material> of a model grows."""
    return material.get("type") == KINEMATIC


def elastic_of(material: ET.Element) -> tuple[ET.Element, float, str]:
    """Return the <elastic> of a material that grows, its multiplier and its curve.

    Raises
    ------
    InputError
        If its growth is another than ours.
    """
    name = material.get("name")
    elastic, growth = material.find("elastic"), material.find("growth")
    if elastic is None or growth is None or growth.get("type") != VOLUME:
        raise InputError(
            f"material '{name}' needs <elastic>, and <growth> of type '{VOLUME}'"
        )
    multiplier = growth.find("multiplier")
    curve = None if multiplier is None else multiplier.get("lc")
    if multiplier is None or curve is None or multiplier.get("type") == "map":
        raise InputError(
            f"material '{name}' needs a <multiplier> that is a number with a load curve"
        )
    return elastic, float(multiplier.text or ""), curve


def growth_along(
    cells: IntArray, stretch: FloatArray, load_factors: FloatArray, name: str
) -> VolumeGrowth:
    """Return the growth of some cells from their stretch at every load factor.

    Raises
    ------
    InputError
        If the volume does not grow in proportion to the load factor.
    """
    swelling = stretch**3 - 1.0
    whole = swelling[-1] / load_factors[-1]
    if np.abs(swelling - whole * load_factors).max() > PROPORTIONAL:
        raise InputError(
            f"the volume of part '{name}' must grow in proportion to the other loads: "
            "the cube of its stretch, less 1, as their load curve"
        )
    return VolumeGrowth(cells, np.full(len(cells), 1.0 + whole))

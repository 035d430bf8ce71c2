"""A load path as a FEBio model (.feb 4.0) that FEBio runs as it is.

Time counts levels: step i ends at time i, and a load curve gives the load factor
there. FEBio prints the displacement of all points after every step to a log of its
own, which `physgnn.io.febio.log` reads. Source of the format: FEBio User Manual 4,
chapter 3. Units are mm, N, MPa.
"""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.atomic import whole_file
from physgnn.io.febio.materials import febio_material
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import Material

REGION_PREFIX = "region-"
AXES = "xyz"

# Full Newton (a quasi-Newton method that makes no updates), tight. FEBio compares the
# square of the residual with rtol, and min_residual is an absolute floor under which it
# takes any state for equilibrium: at forces of millinewtons it must be 0.
CONTROL = """\
  <Control>
    <analysis>STATIC</analysis>
    <time_steps>{steps}</time_steps>
    <step_size>1</step_size>
    <solver type="solid">
      <symmetric_stiffness>symmetric</symmetric_stiffness>
      <max_refs>50</max_refs>
      <dtol>1e-06</dtol>
      <etol>1e-10</etol>
      <rtol>1e-16</rtol>
      <min_residual>0</min_residual>
      <qn_method type="BFGS">
        <max_ups>0</max_ups>
      </qn_method>
    </solver>
  </Control>"""
FIXED = """\
    <bc name="fixed" type="zero displacement" node_set="fixed">
      <x_dof>1</x_dof>
      <y_dof>1</y_dof>
      <z_dof>1</z_dof>
    </bc>"""
LOAD = """\
    <nodal_load name="force-{axis}" type="nodal_load" node_set="loaded">
      <dof>{axis}</dof>
      <scale lc="1" type="map">force-{axis}</scale>
    </nodal_load>"""
OUTPUT = """\
  <Output>
    <plotfile type="febio">
      <var type="displacement"/>
    </plotfile>
    <logfile>
      <node_data data="ux;uy;uz" file="{log}"/>
    </logfile>
  </Output>"""


def write_febio(
    path: str | Path,
    mesh: TetMesh,
    load_path: LoadPath,
    *,
    materials: Mapping[int, Material],
    fixed: IntArray,
) -> None:
    """Write a model whose steps are the levels of a load path.

    Parameters
    ----------
    path : path
        Ends in .feb; FEBio writes its log of displacements beside it, see `log_of`.
    mesh : TetMesh
        One part a region.
    load_path : LoadPath
        Its nodes may not be fixed.
    materials : mapping of region to material
        One for every region of the mesh.
    fixed : (n_fixed,) integer array
        Points held at zero displacement.

    Raises
    ------
    InputError
        If the name does not end in .feb, the load does not fit the mesh, or a region
        has no material.
    """
    path = Path(path)
    if path.suffix != ".feb":
        raise InputError(
            f"{path}: a FEBio model is written as .feb (got '{path.suffix}')"
        )
    load_path.case(0).check_against(mesh, fixed)  # refuses loads that are no forces
    lines = _model(mesh, load_path, materials, fixed, log_of(path).name)
    with whole_file(path) as part, part.open("w", encoding="utf-8") as file:
        file.writelines(f"{line}\n" for line in lines)


def log_of(model: Path) -> Path:
    """Return where FEBio logs the displacements of a model written here."""
    return model.with_name(f"{model.stem}-displacement.log")


def _model(
    mesh: TetMesh,
    load_path: LoadPath,
    materials: Mapping[int, Material],
    fixed: IntArray,
    log: str,
) -> Iterator[str]:
    regions = np.unique(mesh.region).tolist()
    yield '<?xml version="1.0" encoding="UTF-8"?>'
    yield '<febio_spec version="4.0">'
    yield '  <Module type="solid"/>'
    yield CONTROL.format(steps=load_path.n_levels)
    yield from _section("Material", _materials(regions, materials))
    yield from _section("Mesh", _mesh(mesh, regions, fixed, load_path.nodes))
    domains = (
        f'    <SolidDomain name="{_part(r)}" mat="{_part(r)}"/>' for r in regions
    )
    yield from _section("MeshDomains", domains)
    yield from _section("MeshData", _forces(load_path.forces))
    yield from _section("Boundary", [FIXED])
    yield from _section("Loads", (LOAD.format(axis=axis) for axis in AXES))
    yield from _section("LoadData", _load_curve(load_path.load_factors))
    yield OUTPUT.format(log=log)
    yield "</febio_spec>"


def _section(name: str, lines: Iterable[str]) -> Iterator[str]:
    yield f"  <{name}>"
    yield from lines
    yield f"  </{name}>"


def _part(region: int) -> str:
    return f"{REGION_PREFIX}{region}"


def _materials(regions: list[int], materials: Mapping[int, Material]) -> Iterator[str]:
    for number, region in enumerate(regions, 1):
        if region not in materials:
            raise InputError(f"region {region} has no material: name one for it")
        kind, values = febio_material(materials[region])
        yield f'    <material id="{number}" name="{_part(region)}" type="{kind}">'
        yield from (f"      <{tag}>{value}</{tag}>" for tag, value in values.items())
        yield "    </material>"


def _mesh(
    mesh: TetMesh,
    regions: list[int],
    fixed: IntArray,
    loaded: IntArray,
) -> Iterator[str]:
    yield '    <Nodes name="all">'
    for i, point in enumerate(mesh.points.tolist(), 1):
        yield f'      <node id="{i}">{_list(point)}</node>'
    yield "    </Nodes>"
    corners = mesh.cells + 1
    for region in regions:
        yield f'    <Elements type="tet4" name="{_part(region)}">'
        for cell in np.flatnonzero(mesh.region == region).tolist():
            nodes = _list(corners[cell].tolist())
            yield f'      <elem id="{cell + 1}">{nodes}</elem>'
        yield "    </Elements>"
    for name, ids in (("fixed", fixed), ("loaded", loaded)):
        yield f'    <NodeSet name="{name}">{_list((ids + 1).tolist())}</NodeSet>'


def _forces(forces: FloatArray) -> Iterator[str]:
    """Yield a map of every component; ``lid`` counts within the node set."""
    for axis, values in zip(AXES, forces.T.tolist(), strict=True):
        yield f'    <NodeData name="force-{axis}" node_set="loaded" data_type="scalar">'
        for i, value in enumerate(values, 1):
            yield f'      <node lid="{i}">{value!r}</node>'
        yield "    </NodeData>"


def _load_curve(load_factors: FloatArray) -> Iterator[str]:
    yield '    <load_controller id="1" type="loadcurve">'
    yield "      <interpolate>LINEAR</interpolate>"
    yield "      <extend>CONSTANT</extend>"
    yield "      <points>"
    for time, factor in enumerate([0.0, *load_factors.tolist()]):
        yield f"        <pt>{time},{factor!r}</pt>"
    yield "      </points>"
    yield "    </load_controller>"


def _list(values: list[Any]) -> str:
    """Join numbers with commas, floats with all their digits."""
    return ",".join(map(repr, values))

"""Linear tetrahedra: internal force, energy and tangent.

Every kernel loops over cells in order and adds up in that order, so a result does
not depend on the number of threads or on the machine's scheduling.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh, shape_gradients
from physgnn.mechanics.elements.averaged_pressure import (
    Averaging,
    cell_pressures,
    make_averaging,
    mean_volume_change,
)
from physgnn.mechanics.elements.cell_kinematics import kinematics, volume_changes
from physgnn.mechanics.materials import table
from physgnn.mechanics.materials.table import MAX_CONSTANTS, Material, law_index

ELEMENTS = ("tet4", "tet4-averaged")
DEFAULT_ELEMENT = "tet4"
NO_PRESSURE = np.empty(0)


@dataclass(frozen=True, eq=False)
class Elements:
    """What the kernels need of a mesh: gradients, volumes and a law for every cell.

    Attributes
    ----------
    cells : (n_cells, 4) int32 array
    gradients : (n_cells, 4, 3) array
        ∂N_a/∂X, 1/mm.
    volumes : (n_cells,) array
        mm³.
    law : (n_cells,) int64 array
        Index into the table of materials.
    constants : (n_cells, 8) array
        The law's constants, MPa.
    n_points : int
    rest : (n_cells,) array
        Diagonal of F where nothing has moved: 1, or 1/g in a cell whose stress-free
        state has grown by the stretch g (`physgnn.mechanics.elements.growth`).
    averaging : Averaging or None
        Groups that share their change of volume; the constants are then without κ.
    """

    cells: NDArray[np.int32]
    gradients: FloatArray
    volumes: FloatArray
    law: IntArray
    constants: FloatArray
    n_points: int
    rest: FloatArray
    averaging: Averaging | None = None


def checked_element(element: str) -> str:
    """Return the name of an element; InputError if there is none of that name."""
    if element not in ELEMENTS:
        raise InputError(
            f"element must be one of {', '.join(ELEMENTS)} (got {element!r})"
        )
    return element


def check_materials(mesh: TetMesh, materials: Mapping[int, Material]) -> None:
    """Raise InputError if a region has no material, or one whose law is not ours."""
    missing = sorted(set(np.unique(mesh.region).tolist()) - set(materials))
    if missing:
        raise InputError(
            f"region {missing[0]} has no material (materials are given for "
            f"{sorted(materials)})"
        )
    for material in materials.values():
        law_index(material)


def make_elements(
    mesh: TetMesh, materials: Mapping[int, Material], element: str = DEFAULT_ELEMENT
) -> Elements:
    """Collect what the kernels need.

    Parameters
    ----------
    mesh : TetMesh
    materials : mapping of region label to Material
    element : str
        One of ``ELEMENTS``.

    Raises
    ------
    InputError
        If a region of the mesh has no material, or element or law is unknown.
    """
    checked_element(element)
    check_materials(mesh, materials)
    law = np.zeros(mesh.n_cells, dtype=np.int64)
    constants = np.zeros((mesh.n_cells, MAX_CONSTANTS))
    for label, material in materials.items():
        inside = mesh.region == label
        law[inside] = law_index(material)
        constants[inside, : len(material.constants)] = material.constants
    averaging = None
    if element == "tet4-averaged":
        averaging = make_averaging(mesh, constants[:, 0].copy())
        constants[:, 0] = 0.0
    return Elements(
        mesh.cells,
        shape_gradients(mesh.points, mesh.cells),
        mesh.cell_volumes,
        law,
        constants,
        mesh.n_points,
        np.ones(mesh.n_cells),
        averaging,
    )


@njit(cache=True, inline="always")
def _add_force(cell, gradient, volume, P, force):  # type: ignore[no-untyped-def]
    for i in range(3):
        x, y, z = volume * P[i, 0], volume * P[i, 1], volume * P[i, 2]
        total = 0.0
        for a in range(1, 4):
            part = x * gradient[a, 0] + y * gradient[a, 1] + z * gradient[a, 2]
            force[cell[a], i] += part
            total += part
        force[cell[0], i] -= total  # a cell pulls on nothing but its own corners


@njit(cache=True, inline="always")
def _add_pressure(pJ, H, P):  # type: ignore[no-untyped-def]
    """Add p ∂J/∂F = p J F⁻ᵀ."""
    for i in range(3):
        for j in range(3):
            P[i, j] += pJ * H[i, j]


@njit(cache=True)
def _internal_force(  # type: ignore[no-untyped-def]
    cells, gradients, rest, volumes, law, constants, pressure, u, force
):
    F, H, P = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    e = 0
    # The first law has a loop of its own: choosing among laws costs a sixth of it.
    while e < len(cells) and law[e] == 0:
        J = kinematics(cells[e], gradients[e], rest[e], u, F, H)
        if not J > 0.0:
            return e
        table.stress(0, F, H, J, constants[e], P)
        if len(pressure):
            _add_pressure(pressure[e] * J, H, P)
        _add_force(cells[e], gradients[e], volumes[e], P, force)
        e += 1
    for e in range(e, len(cells)):  # noqa: B020
        J = kinematics(cells[e], gradients[e], rest[e], u, F, H)
        if not J > 0.0:
            return e
        table.stress(law[e], F, H, J, constants[e], P)
        if len(pressure):
            _add_pressure(pressure[e] * J, H, P)
        _add_force(cells[e], gradients[e], volumes[e], P, force)
    return -1


@njit(cache=True)
def energy_of(chosen, cells, gradients, rest, volumes, law, constants, u):  # type: ignore[no-untyped-def]
    """Return the strain energy of some cells, N mm; infinite if one is inverted."""
    F, H = np.empty((3, 3)), np.empty((3, 3))
    total = 0.0
    for e in chosen:
        J = kinematics(cells[e], gradients[e], rest[e], u, F, H)
        if not J > 0.0:
            return np.inf
        total += volumes[e] * table.energy(law[e], F, J, constants[e])
    return total


@dataclass(frozen=True, eq=False)
class MeanState:
    """The averaged change of volume at one displacement."""

    mean: FloatArray
    cofactors: FloatArray
    pressure: FloatArray


def check_state(elements: Elements, u: FloatArray) -> None:
    """Raise InputError unless u has one row a point: kernels read without looking."""
    if u.shape != (elements.n_points, 3):
        raise InputError(
            f"a displacement must have shape ({elements.n_points}, 3), one row a point "
            f"(got {u.shape})"
        )


def mean_state(elements: Elements, u: FloatArray) -> tuple[MeanState | None, int]:
    """Average the change of volume; None and the first inverted cell if one is."""
    check_state(elements, u)
    averaging = elements.averaging
    assert averaging is not None
    J = np.empty(len(elements.cells))
    cofactors = np.empty((len(J), 3, 3))
    inverted = volume_changes(
        elements.cells, elements.gradients, elements.rest, u, J, cofactors
    )
    if inverted >= 0:
        return None, int(inverted)
    mean = mean_volume_change(J, elements.volumes, averaging.groups, averaging.volumes)
    pressure = cell_pressures(mean, averaging.kappa, averaging.groups)
    return MeanState(mean, cofactors, pressure), -1


def internal_force(elements: Elements, u: FloatArray) -> tuple[FloatArray, int]:
    """Σ_e V P·∂N_a/∂X.

    Returns
    -------
    force : (n_points, 3) array
        N.
    inverted : int
        First cell with det F ≤ 0, or −1; the force is then of no use.
    """
    check_state(elements, u)
    force = np.zeros((elements.n_points, 3))
    pressure = NO_PRESSURE
    if elements.averaging is not None:
        state, inverted = mean_state(elements, u)
        if state is None:
            return force, inverted
        pressure = state.pressure
    inverted = _internal_force(
        elements.cells,
        elements.gradients,
        elements.rest,
        elements.volumes,
        elements.law,
        elements.constants,
        pressure,
        u,
        force,
    )
    return force, int(inverted)


def strain_energy(elements: Elements, u: FloatArray) -> float:
    """Σ_e V W(F), N·mm; infinite if a cell is inverted."""
    check_state(elements, u)
    total = float(
        energy_of(
            np.arange(len(elements.cells)),
            elements.cells,
            elements.gradients,
            elements.rest,
            elements.volumes,
            elements.law,
            elements.constants,
            u,
        )
    )
    averaging = elements.averaging
    if averaging is None or not np.isfinite(total):
        return total
    state, _ = mean_state(elements, u)
    assert state is not None
    cost = averaging.kappa / 2 * np.log(state.mean) ** 2
    return total + float((averaging.volumes * cost).sum())

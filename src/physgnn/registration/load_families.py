"""What may push a brain aside: a few hundred smooth forces, in families.

Weight: the same force on all tissue, in three directions (gravity when the fluid
around is gone). Surface: Gaussian patches of traction all over the free surface, in
three directions (retractors, loss of support, suction). Inside: Gaussian clouds of
force in all tissue, in three directions; they stand for what the model does not know,
such as how stiffness varies. To these three come the physiological causes that the
body has the sets for (`physgnn.registration.causes`).

Pressure within a region is not among them: as dead forces on nearly incompressible
tissue it makes equilibrium unstable once it exceeds the shear modulus, and shifts of a
millimetre would ask for that. Tissue that swells is a growth mode therefore
(`physgnn.registration.mode_response`).

Each family is scaled so that its response has a root mean square of 1 mm on the
surface if all its modes have independent coefficients of variance 1: its variance is
then in mm².
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.boundary import boundary_points
from physgnn.geometry.measured import farthest_points
from physgnn.geometry.regions import VENTRICLE
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.elements.growth import growth_force
from physgnn.mechanics.elements.tet4 import Elements
from physgnn.registration.causes import modes_of_causes
from physgnn.registration.skull import point_areas

Solve = Callable[[FloatArray], NDArray[Any]]  # K₀⁻¹ f, (k, n_points, 3) both

# Of a volume ratio beforehand: an assumption. Mannitol and oedema change the volume of
# tissue by some per cent.
GROWTH_DEVIATION = 0.05

PATCH_SPACING_MM, CLOUD_SPACING_MM = 25.0, 35.0
WIDTH_PER_SPACING = 0.7  # a blob's standard deviation: neighbours overlap


@dataclass(frozen=True, eq=False)
class LoadModes:
    """Loads and the linear response to each; dead forces first, growth last.

    Attributes
    ----------
    forces : (n_modes, n_points, 3) float32 array
        N; of growth, what it adds at rest.
    response : (n_modes, n_points, 3) float32 array
        K₀⁻¹ of each, mm.
    family : (n_modes,) integer array
        Index into `names`.
    names : tuple of str
        The families.
    growth : (n_growing, n_cells) array
        Change of the volume ratio for a coefficient of 1, of the last modes.
    most : (n_families,) array
        Standard deviation of the coefficients that a family's may not exceed.
    """

    forces: NDArray[np.float32]
    response: NDArray[np.float32]
    family: IntArray
    names: tuple[str, ...]
    growth: FloatArray
    most: FloatArray


def load_modes(
    mesh: TetMesh,
    skull: IntArray,
    solve: Solve,
    *,
    elements: Elements,
    causes: Sequence[str] | None = None,
) -> LoadModes:
    """Return the load modes of a body; a second or two, once a patient.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    skull : integer array
        Points of the surface that are not exposed.
    solve : callable
        Linear elasticity of the rest state.
    elements : Elements
        Of the rest state.
    causes : sequence of str or None
        Rows of `physgnn.registration.causes.CAUSES`; None takes all that the body has
        the sets for.

    Raises
    ------
    InputError
        If there is no such cause, or the body lacks what it acts on.
    """
    free = np.setdiff1d(boundary_points(mesh), skull)
    found = modes_of_causes(mesh, free, causes)
    dead = {"weight": _weight(mesh), "surface": _patches(mesh, free)}
    dead |= {"inside": _clouds(mesh)}
    dead |= {name: one.forces for name, one in found.items() if len(one.forces)}
    grows = {name: one.growth for name, one in found.items() if len(one.growth)}
    forces, response, family, most = [], [], [], []
    growth = [np.empty((0, mesh.n_cells))]
    for i, name in enumerate((*dead, *grows)):
        loads = dead[name] if name in dead else _at_rest(elements, grows[name])
        moved = solve(loads).astype(np.float64)
        scale = 1.0 / np.sqrt((moved[:, free] ** 2).sum(axis=(0, 2)).mean())
        forces.append((scale * loads).astype(np.float32))
        response.append((scale * moved).astype(np.float32))
        family.append(np.full(len(loads), i))
        if name in grows:
            growth.append(scale * grows[name])
        most.append(GROWTH_DEVIATION / scale if name in grows else np.inf)
    return LoadModes(
        np.concatenate(forces),
        np.concatenate(response),
        np.concatenate(family),
        (*dead, *grows),
        np.concatenate(growth),
        np.array(most),
    )


def _at_rest(elements: Elements, growth: FloatArray) -> FloatArray:
    """Return the force that each growth adds at rest, (n, n_points, 3), N."""
    rest, none = np.ones(len(elements.cells)), np.zeros((elements.n_points, 3))
    return -np.stack([growth_force(elements, rest, one, none) for one in growth])


def _weight(mesh: TetMesh) -> FloatArray:
    return np.eye(3)[:, None, :] * _point_volumes(mesh)[None, :, None]


def _clouds(mesh: TetMesh) -> FloatArray:
    every = np.arange(mesh.n_points)
    return _blobs(mesh.points, every, _point_volumes(mesh), CLOUD_SPACING_MM)


def _patches(mesh: TetMesh, free: IntArray) -> FloatArray:
    area = point_areas(mesh)
    return _blobs(mesh.points, free, area, PATCH_SPACING_MM)


def _point_volumes(mesh: TetMesh) -> FloatArray:
    """Return every point's share of the tissue: fluid in ventricles bears itself."""
    share = np.zeros(mesh.n_points)
    tissue = mesh.region != VENTRICLE
    np.add.at(share, mesh.cells[tissue], mesh.cell_volumes[tissue, None] / 4)
    return share


def _blobs(
    points: FloatArray, chosen: IntArray, measure: FloatArray, spacing: float
) -> FloatArray:
    """Gaussians among the chosen points, times their measure, along x, y and z."""
    inside = points[chosen]
    centres = inside[farthest_points(inside, spacing=spacing)]
    loads = np.zeros((len(centres), 3, len(points), 3))
    for load, centre in zip(loads, centres, strict=True):
        square = ((inside - centre) ** 2).sum(axis=1)
        blob = np.exp(-square / (2 * (WIDTH_PER_SPACING * spacing) ** 2))
        for axis in range(3):
            load[axis, chosen, axis] = measure[chosen] * blob
    return loads.reshape(-1, len(points), 3)

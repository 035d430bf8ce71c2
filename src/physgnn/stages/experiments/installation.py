"""Whether an installation computes what it should: closed forms and stored results."""

import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.bundled import BUNDLED_RUN
from physgnn.progress import Progress
from physgnn.scratch import scratch_folder

if TYPE_CHECKING:
    from physgnn.geometry import TetMesh
    from physgnn.mechanics import LoadCase

YOUNGS_MODULUS_PA, POISSONS_RATIO = 3000.0, 0.4
STRETCH = np.array([0.1, -0.05, 0.2])  # u = z times this
FORCE_N, RADIUS_MM = 1.0, 20.0  # on the bundled brain
STORED = {
    "network": (6.289046, 0.397155),
    "finite elements": (6.301419, 0.397660),
}
"""Largest and mean displacement under that load, mm, made by this package."""
STORED_LIMIT_MM = 2e-3  # processors round differently, and the solver stops at 1e-3
KILL_WAIT_SECONDS = 60.0
LOADS = f"""
[materials.brain]
youngs_modulus_pa = {YOUNGS_MODULUS_PA}
poissons_ratio = {POISSONS_RATIO}
[loads]
total_force_n = 0.02
paths = 40
levels = 3
nodes_per_path = 3
"""
SIMULATE = "import sys; from physgnn.cli import command; command()"


@dataclass(frozen=True)
class Check:
    """One row of the self-test.

    Attributes
    ----------
    name : str
        What was compared with what.
    found, limit : float
        The difference, and how large it may be, in `unit`.
    unit : str
        Such as mm.
    """

    name: str
    found: float
    limit: float
    unit: str

    @property
    def passed(self) -> bool:
        """Whether the difference is within the limit; one that is no number is not."""
        return bool(self.found <= self.limit)


def selftest(*, progress: Progress | None = None) -> tuple[Check, ...]:
    """Check this installation in about a minute.

    Finite elements are compared with a closed form and a stored result, the network
    with a stored result and with finite elements, a warp with its inverse, a resumed
    data set with one that was never interrupted.

    Parameters
    ----------
    progress : callable, optional
        Called with the checks done, the checks in all, and what comes next.

    Returns
    -------
    tuple of Check
        What was found; the installation works if all have passed.
    """
    made: list[Check] = []
    for i, (name, check) in enumerate(CHECKS.items()):
        if progress is not None:
            progress(i, len(CHECKS), name)
        made += check()
    return tuple(made)


def _closed_form() -> list[Check]:
    """Load a block by the tractions of a homogeneous deformation, u = z a.

    P = μ (F − F⁻ᵀ) + λ ln J F⁻ᵀ is the compressible neo-Hookean law of Bonet and Wood,
    Nonlinear Continuum Mechanics for Finite Element Analysis, 2nd edition, 6.28.
    """
    from physgnn.mechanics import Body, LoadCase, NeoHookean
    from physgnn.prediction.finite_element import FiniteElementPredictor

    mesh = _block()
    body = Body(
        mesh,
        {0: NeoHookean(YOUNGS_MODULUS_PA, POISSONS_RATIO)},
        mesh.point_set("fixed"),
    )
    forces = _tractions(mesh, _neo_hookean(np.eye(3) + np.outer(STRETCH, [0, 0, 1])))
    free = np.setdiff1d(np.flatnonzero(forces.any(axis=1)), body.fixed)
    found = FiniteElementPredictor(body)(
        LoadCase(free, forces[free]), tolerance_mm=1e-5
    )
    exact = mesh.points[:, 2:] * STRETCH
    error = np.abs(found.displacement - exact).max()
    return [Check("finite elements, a closed form", float(error), 1e-4, "mm")]


def _neo_hookean(F: FloatArray) -> FloatArray:
    """Return the first Piola-Kirchhoff stress, N/mm²."""
    young, poisson = 1e-6 * YOUNGS_MODULUS_PA, POISSONS_RATIO
    mu = young / (2 * (1 + poisson))
    lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    inverse = np.linalg.inv(F).T
    stress: FloatArray = mu * (F - inverse) + lame * np.log(np.linalg.det(F)) * inverse
    return stress


def _tractions(mesh: "TetMesh", P: FloatArray) -> FloatArray:
    """Return the nodal forces of P N on the whole surface, N, (n_points, 3)."""
    from physgnn.geometry import boundary_faces
    from physgnn.geometry.normals import area_vectors

    faces = boundary_faces(mesh)
    area = area_vectors(mesh.points, faces)
    forces = np.zeros_like(mesh.points)
    for corner in faces.T:
        np.add.at(forces, corner, area @ P.T / 3)
    return forces


def _block(n: int = 4, side: float = 10.0) -> "TetMesh":
    """Return a cube of n³ cubes, six tetrahedra each, its bottom fixed."""
    from itertools import permutations

    from physgnn.geometry import TetMesh

    axis = np.linspace(0.0, side, n + 1)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    steps = np.array([(n + 1) ** 2, n + 1, 1])
    corner = np.arange((n + 1) ** 3).reshape((n + 1,) * 3)[:-1, :-1, :-1].ravel()
    cells = []
    for order in permutations(range(3)):
        chain = [corner + sum(steps[list(order[:i])]) for i in range(4)]
        even = np.linalg.det(np.eye(3)[list(order)]) > 0
        cells.append(np.stack(chain if even else [chain[i] for i in (0, 2, 1, 3)], -1))
    at_bottom = np.flatnonzero(points[:, 2] == 0.0)
    at_top = np.flatnonzero(points[:, 2] == side)
    all_cells = np.concatenate(cells).astype(np.int32)
    sets = {"fixed": at_bottom, "loaded": at_top}
    return TetMesh(points, all_cells, np.zeros(len(all_cells), np.int32), sets)


def _patient_load() -> "LoadCase":
    """Return a load on the middle of the bundled brain's craniotomy."""
    from physgnn.serving.scene.patch_load import spread_force
    from physgnn.serving.scene.viewed import view_run

    exposed = view_run(BUNDLED_RUN, "").exposed
    from_centre = np.linalg.norm(exposed.points - exposed.points.mean(axis=0), axis=1)
    middle = int(from_centre.argmin())
    force = -FORCE_N * exposed.normals[middle]
    return spread_force(exposed, exposed.points[middle], force, RADIUS_MM)


def _patient() -> list[Check]:
    """Network, bound, solver and warp on the bundled brain."""
    from physgnn.imaging import forward_field, grid_around, inverse_field, round_trip_mm
    from physgnn.prediction import Predictor
    from physgnn.prediction.finite_element import FiniteElementPredictor

    predictor, case = Predictor.load(BUNDLED_RUN, warm=False), _patient_load()
    predicted = predictor(case)
    solved = FiniteElementPredictor(predictor.body)(case)
    u, exact = predicted.displacement, solved.displacement
    error = np.linalg.norm(u - exact, axis=1).max()
    bound = predicted.error_estimate_mm
    mesh = predictor.body.mesh
    grid = grid_around(mesh, spacing_mm=4.0, margin_mm=20.0)
    trip = round_trip_mm(forward_field(mesh, u, grid), inverse_field(mesh, u, grid))
    return [
        _stored("finite elements", exact),
        _stored("network", u),
        Check(
            "network, error within its bound",
            float(error),
            np.nan if bound is None else bound.max_mm,
            "mm",
        ),
        Check("warp and back, mean", float(trip.mean()), 0.05, "mm"),
    ]


def _stored(name: str, displacement: FloatArray) -> Check:
    """Compare the largest and the mean displacement with those stored."""
    length = np.linalg.norm(displacement, axis=1)
    off = np.abs(np.array([length.max(), length.mean()]) - STORED[name]).max()
    return Check(f"{name}, a stored result", float(off), STORED_LIMIT_MM, "mm")


def _resume() -> list[Check]:
    """Kill a simulation, resume it, and compare with one that was never interrupted."""
    from physgnn.dataset import Store
    from physgnn.io import write_mesh

    with scratch_folder("selftest") as name:
        folder = Path(name)
        write_mesh(folder / "case.vtu", _block(3))
        (folder / "loads.toml").write_text(LOADS)
        killed, whole = folder / "killed.zarr", folder / "whole.zarr"
        with _simulating(folder, killed) as process:
            end = time.monotonic() + KILL_WAIT_SECONDS
            while process.poll() is None and not _some_paths(killed):
                if time.monotonic() > end:
                    break
                time.sleep(0.01)
            process.kill()
        for store in (killed, whole):
            with _simulating(folder, store) as process:
                process.wait()
        stores = [Store.open(store) for store in (killed, whole)]
        differ = stores[0].content_hash() != stores[1].content_hash()
        left = sum(len(store.pending()) for store in stores)
    return [
        Check("a killed simulation, resumed", float(differ + left), 0.0, "differences")
    ]


def _some_paths(store: Path) -> bool:
    from physgnn.dataset import Store
    from physgnn.errors import InputError

    try:
        opened = Store.open(store)
        return 0 < len(opened.pending()) < opened.n_paths
    except (InputError, OSError, ValueError, KeyError):
        return False  # it is being made


def _simulating(folder: Path, out: Path) -> "subprocess.Popen[bytes]":
    options = ["simulate", "case.vtu", "--loads", "loads.toml", "--workers", "1"]
    return subprocess.Popen(
        [sys.executable, "-c", SIMULATE, *options, "-o", str(out)],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


CHECKS: Mapping[str, Callable[[], list[Check]]] = {
    "a closed form": _closed_form,
    "the bundled brain": _patient,
    "a kill": _resume,
}

"""Shifts of a brain whose mesh, tissue and skull the registration does not know.

Simulated on another mesh than the one that is registered, finer, with other materials
(Poisson's ratio, stiffness of the tumour) and other points at the skull, under loads
outside the span of the load modes: weight in a random direction near the craniotomy's,
a retractor's narrow patch, and a pull on the tumour. Where the skull lets slide, it
resists a third as much as the registration thinks.
"""

from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from physgnn.arrays import FloatArray
from physgnn.evaluation.in_silico.cases import Case, SeenPlaces
from physgnn.geometry import (
    Complement,
    Phantom,
    Sphere,
    TetMesh,
    mni152_phantom,
    select,
    tetrahedralize,
)
from physgnn.mechanics import NeoHookean
from physgnn.mechanics.body import Body
from physgnn.registration.skull import ALONG_MM, Support, fixed_support, sliding_support
from physgnn.registration.tangent_response import TangentResponse

SHIFT_MM = (5.0, 12.0)
TRUE_HELD_MM = 80.0
BUCKLED = 1.5  # times the linear solution
SURFACE_POINTS = 900
LEVELS, MAX_STEPS, CONVERGED_MM = 8, 15, 1e-3
TRUE_MATERIALS = {0: NeoHookean(2500.0, 0.45), 1: NeoHookean(9000.0, 0.47)}


def held(mesh: TetMesh, phantom: Phantom, radius_mm: float) -> TetMesh:
    """Return the mesh with the surface fixed outside of a sphere about the opening."""
    opening = Sphere(tuple(phantom.craniotomy_point), radius_mm)
    return mesh.with_point_sets(fixed=select(mesh, Complement(opening)))


def _support(body: Body, skull: str) -> Support:
    if skull == "fixed":
        return fixed_support(body)
    return sliding_support(body, along_mm=3.0 * ALONG_MM)


class Truth:
    """Simulates shifts of a body that the registration does not know.

    Parameters
    ----------
    n_points : int
        About how many the mesh has.
    skull : {"fixed", "sliding"}
        How the skull holds it.
    surface_points : int
        About how many the brain's surface has.
    """

    def __init__(
        self, n_points: int, skull: str, *, surface_points: int = SURFACE_POINTS
    ) -> None:
        self._skull = skull
        self.phantom = mni152_phantom(n_points=surface_points)
        surfaces = self.phantom.brain, self.phantom.tumours
        mesh = tetrahedralize(*surfaces, target_points=n_points)
        self.mesh = held(mesh, self.phantom, TRUE_HELD_MM)
        self.places = SeenPlaces(self.mesh, self.phantom.craniotomy_point)
        self.free, self.exposed = self.places.free, self.places.exposed

    @cached_property
    def tangent(self) -> TangentResponse:
        """How the body responds to forces; made when it is first wanted."""
        body = Body(self.mesh, TRUE_MATERIALS)
        return TangentResponse(body, _support(body, self._skull))

    def case(self, seed: int) -> Case:
        """Simulate a shift and measure it; the same seed gives the same one."""
        rng = np.random.default_rng(seed)
        wanted = rng.uniform(*SHIFT_MM)
        forces = self._forces(rng)
        forces *= wanted / np.linalg.norm(self._linear(forces), axis=1).max()
        levels = self._equilibria(forces)
        reached = np.array([np.linalg.norm(u, axis=1).max() for u in levels])
        # a body that buckles under a retractor is no brain any more
        sound = reached < BUCKLED * wanted * np.arange(1, len(levels) + 1) / LEVELS
        u = levels[np.argmin(np.where(sound, abs(reached - wanted), 99))]
        return self.places.measured(u, rng, seed)

    def _linear(self, forces: FloatArray) -> FloatArray:
        rest = np.zeros_like(forces)
        found = self.tangent(rest, forces[None].astype(np.float32))
        assert found is not None
        moved: FloatArray = found[0][0].astype(np.float64)
        return moved

    def _equilibria(self, forces: FloatArray) -> list[FloatArray]:
        """Newton's method, level by level, as far as it goes."""
        u = np.zeros_like(forces)
        found: list[FloatArray] = []
        for level in range(1, LEVELS + 1):
            load = (level / LEVELS * forces)[None].astype(np.float32)
            for _ in range(MAX_STEPS):
                solved = self.tangent(u, load)
                if solved is None:
                    return found
                step = solved[0][0] + solved[1]
                u = u + step
                if np.linalg.norm(step, axis=1).max() < CONVERGED_MM:
                    found.append(u)
                    break
            else:
                return found
        return found

    def _forces(self, rng: np.random.Generator) -> FloatArray:
        """Weight, a retractor and a pull on the tumour, in random proportions."""
        mesh, phantom = self.mesh, self.phantom
        inward = mesh.points.mean(axis=0) - phantom.craniotomy_point
        inward /= np.linalg.norm(inward)
        share = np.zeros(mesh.n_points)
        np.add.at(share, mesh.cells, mesh.cell_volumes[:, None] / 4)
        weight = share[:, None] * _near(rng, inward, 40.0)
        centre = mesh.points[rng.choice(self.exposed)]
        width = rng.uniform(15.0, 25.0)
        square = ((mesh.points - centre) ** 2).sum(axis=1) / (2 * width**2)
        retractor = np.zeros_like(weight)
        retractor[self.free] = np.exp(-square)[self.free, None] * _near(
            rng, inward, 60.0
        )
        tumour = np.unique(mesh.cells[mesh.region == 1])
        pull = np.zeros_like(weight)
        pull[tumour] = share[tumour, None] * _near(rng, inward, 180.0)
        parts = [weight, retractor, pull]
        largest = [np.linalg.norm(self._linear(f), axis=1).max() for f in parts]
        amounts = rng.uniform([0.3, 0.0, 0.0], [1.0, 0.5, 0.2])
        total: FloatArray = np.zeros_like(weight)
        for amount, size, force in zip(amounts, largest, parts, strict=True):
            total += amount / size * force
        return total


def _near(
    rng: np.random.Generator, direction: FloatArray, degrees: float
) -> FloatArray:
    axis = np.cross(direction, rng.normal(size=3))
    turn = np.deg2rad(rng.uniform(0, degrees)) * axis / np.linalg.norm(axis)
    turned: FloatArray = Rotation.from_rotvec(turn).apply(direction)
    return turned

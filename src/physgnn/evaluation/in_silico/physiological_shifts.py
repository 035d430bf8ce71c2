"""Shifts whose cause physiology names: swelling, contraction, sag, resection.

Tissue within 25 mm of the tumour swells, all brain contracts, the brain sags as the
fluid drains, or the tumour is taken out and the cavity falls together as the fluid
drains. How much, which way is down and where the fluid stands are drawn.
"""

from collections.abc import Callable, Mapping

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.evaluation.in_silico.shifts import TRUE_MATERIALS, Truth
from physgnn.geometry import TetMesh
from physgnn.mechanics import Gravity, LoadPath, NeoHookean, Solver
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.growth_rules import GrowthIn
from physgnn.mechanics.loads.sampling import equal_levels
from physgnn.registration.removed_region import resected

# A brain's own weight moves it by as much as is seen only if it is softer than the
# published one.
SOFT = {i: NeoHookean(1500.0 * (1 + 2 * i), 0.45) for i in TRUE_MATERIALS}
FACTORS = equal_levels(5)

PhysiologicalShift = Callable[[Truth, np.random.Generator], tuple[TetMesh, FloatArray]]
"""From a body to the mesh of what is left of it and its displacement, mm."""


def swelling(truth: Truth, rng: np.random.Generator) -> tuple[TetMesh, FloatArray]:
    """Swell the tissue around the tumour."""
    rule = GrowthIn(rng.uniform(1.04, 1.10), near="tumour", within_mm=25.0)
    return truth.mesh, solved(truth.mesh, LoadPath.of(FACTORS, rule.on(truth.mesh)))


def contraction(truth: Truth, rng: np.random.Generator) -> tuple[TetMesh, FloatArray]:
    """Draw water from all of the brain, as mannitol does."""
    rule = GrowthIn(rng.uniform(0.95, 0.98), region="brain")
    return truth.mesh, solved(truth.mesh, LoadPath.of(FACTORS, rule.on(truth.mesh)))


def sag(truth: Truth, rng: np.random.Generator) -> tuple[TetMesh, FloatArray]:
    """Sink from the opening as the fluid drains."""
    load = drained(truth, rng)
    return truth.mesh, solved(truth.mesh, LoadPath.of(FACTORS, load), SOFT)


def collapse(truth: Truth, rng: np.random.Generator) -> tuple[TetMesh, FloatArray]:
    """Take the tumour out and let the fluid drain: the cavity falls together."""
    rest = resected(truth.mesh, "tumour").remaining
    return rest, solved(rest, LoadPath.of(FACTORS, drained(truth, rng)), SOFT)


def drained(truth: Truth, rng: np.random.Generator) -> Gravity:
    """Return weight into the opening, leaning a little, above some level of fluid."""
    inward = truth.mesh.points.mean(axis=0) - truth.phantom.craniotomy_point
    down = inward / np.linalg.norm(inward) + rng.normal(scale=0.2, size=3)
    down /= np.linalg.norm(down)
    height = -truth.mesh.points @ down
    level = height.min() + rng.uniform(0.3, 0.7) * np.ptp(height)
    return Gravity(tuple(down), fluid_level_mm=float(level))


def solved(
    mesh: TetMesh, path: LoadPath, materials: Mapping[int, NeoHookean] = TRUE_MATERIALS
) -> FloatArray:
    """Return the displacement at the last level that came to equilibrium.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    path : LoadPath
        What moves it.
    materials : mapping
        By region.

    Raises
    ------
    InputError
        If there is none.
    """
    found = Solver(Body(mesh, materials)).solve(path)
    reached = int((found.status == 0).sum())
    if not reached:
        raise InputError(f"no level came to equilibrium: {found.message}")
    last: FloatArray = found.displacement[reached - 1]
    return last

"""FEBio 4.11 found the same displacements: three laws, forces, gravity, pressure."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.equilibrium.solver import SolverOptions, solve
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.pressure import SurfacePressure
from physgnn.mechanics.materials import Material, MooneyRivlin, NeoHookean, Ogden

AGREES_MM = 3e-5
TIGHT = SolverOptions(tolerance_mm=1e-6)
Arrays = Mapping[str, np.ndarray[Any, Any]]

NEO_HOOKEAN = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
MOONEY_RIVLIN = {
    0: MooneyRivlin(400.0, 103.0, 50_000.0),
    1: MooneyRivlin(900.0, 300.0, 120_000.0),
}
OGDEN = {
    0: Ogden((1684.0,), (-4.7,), 41_841.0),
    1: Ogden((3000.0, 500.0), (-4.7, 3.0), 100_000.0),
}


@pytest.fixture(scope="module")
def answers(shared: Path) -> Arrays:
    with np.load(shared / "febio" / "febio_laws_and_loads.npz") as file:
        return dict(file)


def largest_difference(
    case: Arrays, path: LoadPath, materials: Mapping[int, Material], theirs: Any
) -> float:
    mesh = TetMesh(case["points"], case["cells"], case["region"].astype(np.int32))
    solution = solve(
        mesh, path, materials=materials, fixed=case["fixed"], options=TIGHT
    )
    assert (solution.status == Status.CONVERGED).all()
    assert np.abs(theirs).max() > 0.1  # not a comparison of two zeros
    return float(np.linalg.norm(solution.displacement - theirs, axis=-1).max())


@pytest.mark.parametrize(
    ("law", "materials"), [("nh", NEO_HOOKEAN), ("mr", MOONEY_RIVLIN)]
)
def test_forces(answers: Arrays, law: str, materials: Mapping[int, Material]) -> None:
    factors = np.array([0.3, 0.6, 1.0])
    path = LoadPath(answers[f"{law}_nodes"], answers[f"{law}_forces"], factors)
    theirs = answers[f"{law}_displacement"]
    assert largest_difference(answers, path, materials, theirs) < AGREES_MM


def test_gravity(answers: Arrays) -> None:
    """Ogden's law, of one term and of two."""
    path = LoadPath.of(np.array([0.4, 1.0]), Gravity((-0.55, -0.35, -0.75), 1040.0))
    theirs = answers["gravity_displacement"]
    assert largest_difference(answers, path, OGDEN, theirs) < AGREES_MM


def test_pressure_that_follows_the_surface(answers: Arrays) -> None:
    path = LoadPath.of(
        np.array([0.4, 1.0]), SurfacePressure(answers["patch_faces"], 300.0)
    )
    theirs = answers["pressure_displacement"]
    assert largest_difference(answers, path, OGDEN, theirs) < AGREES_MM


@pytest.mark.slow
@pytest.mark.parametrize("name", ["febio_ds1_path0", "febio_ds2_path1"])
def test_the_published_loads(shared: Path, name: str) -> None:
    with np.load(shared / "febio" / f"{name}.npz") as file:
        case = dict(file)
    factors = case["levels"] / 30
    path = LoadPath(case["load_nodes"], case["load_vectors"], factors)
    theirs = case["displacement"]
    assert largest_difference(case, path, NEO_HOOKEAN, theirs) < AGREES_MM

"""Make the model that comes with the package: a brain, pushed as the live view pushes.

A load path is a push on the exposed surface: a patch of random place and radius, a
direction within a cone about the way in, and the force that the patch's nodes stand.
"""

import shutil
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physgnn.bundled import BUNDLED_RUN
from physgnn.dataset import PRESETS
from physgnn.errors import InputError
from physgnn.geometry import TetMesh, boundary_surface, vertex_normals
from physgnn.geometry.point_sets import Nearest
from physgnn.mechanics.load_paths import equal_levels, within_cone
from physgnn.mechanics.loads import LoadPath
from physgnn.stages.pipeline import Log, Pipeline, Recipe, Show

MAX_BYTES = 5_000_000
CRANIOTOMY_MM = (42.0, 9.1, 60.6)  # the cortex above the bundled tumour


def push_paths(
    mesh: TetMesh,
    loaded: NDArray[np.int64],
    *,
    n_paths: int,
    n_levels: int,
    radius_mm: tuple[float, float] = (10.0, 30.0),
    total_force_n: float = 4.0,
    nodal_force_n: float = 0.2,
    cone_deg: float = 35.0,
    seed: int = 0,
) -> list[LoadPath]:
    """Return load paths that push as a finger on the live view does.

    Parameters
    ----------
    mesh : TetMesh
    loaded : (n_loaded,) integer array
        The exposed nodes.
    n_paths, n_levels : int
        How many, and equal steps of each.
    radius_mm : (float, float)
        A patch's radius is uniform between these.
    total_force_n, nodal_force_n : float
        At load factor 1 a path has the greatest force that exceeds neither, N.
    cone_deg : float
        Half-angle of the cone, degrees.
    seed : int
        Of the random draws.
    """
    from physgnn.serving.patch import Exposed, push

    nodes = np.sort(loaded)
    normals = vertex_normals(boundary_surface(mesh))[nodes]
    exposed = Exposed(nodes, mesh.points[nodes], normals)
    random = np.random.default_rng(seed)
    paths = []
    for _ in range(n_paths):
        centre = exposed.points[random.integers(len(nodes))]
        radius = random.uniform(*radius_mm)
        near = np.linalg.norm(exposed.points - centre, axis=1) < radius
        direction = within_cone(random, -exposed.normals[near].mean(axis=0), cone_deg)
        unit = push(exposed, centre, direction, radius)
        peak = np.linalg.norm(unit.forces, axis=1).max()
        force = min(total_force_n, nodal_force_n / peak)
        paths.append(LoadPath(unit.nodes, force * unit.forces, equal_levels(n_levels)))
    return paths


BUNDLED = Recipe(
    "physgnn bundle",
    surface_points=1500,
    target_points=10_000,
    preset=replace(
        PRESETS["demo"],
        paths=partial(push_paths, n_paths=60, n_levels=10),
        loaded=Nearest(CRANIOTOMY_MM, 90),
    ),
    training_minutes=15.0,
)


def bundle(
    folder: str | Path, out: str | Path = BUNDLED_RUN, *, show: Show, log: Log
) -> Path:
    """Make the bundled model, about an hour's work on 2 cores, and return where it is.

    Parameters
    ----------
    folder : path
        Gets simulations, training and report; a second call goes on where one ended.
    out : path
        Gets what predictions need, and the model card.
    show, log : callables
        See `Pipeline`.

    Raises
    ------
    InputError
        If it came out larger than the package may carry.
    """
    from physgnn.evaluation.tables import accuracy_table

    out = Path(out)
    pipeline = Pipeline(Path(folder), BUNDLED, show, log)
    report = pipeline.run()
    slim_copy(pipeline.trained, out, errors=accuracy_table(report).text())
    check_size(out)
    return out


def check_size(run: Path) -> None:
    """Raise InputError if a run is larger than the package may carry."""
    size = sum(file.stat().st_size for file in run.iterdir())
    if size > MAX_BYTES:
        raise InputError(
            f"{run} must have at most {MAX_BYTES} bytes (got {size}): use fewer points "
            "or modes"
        )


def slim_copy(run: Path, out: Path, *, errors: str) -> None:
    """Copy what predictions need of a run, without paths of the machine it's from.

    Parameters
    ----------
    run, out : Path
        Run folders.
    errors : str
        For the model card, Markdown.
    """
    from physgnn.learning.checkpoint import CASE, Checkpoint
    from physgnn.learning.model_card import write_model_card

    checkpoint = Checkpoint.load(run)
    data = {**checkpoint.record["data"], "path": BUNDLED.command}
    out.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(run / CASE, out / CASE)
    for calibration in run.glob("calibration*.json"):
        shutil.copyfile(calibration, out / calibration.name)
    Checkpoint(checkpoint.model, {**checkpoint.record, "data": data}).save(out)
    write_model_card(out, errors)

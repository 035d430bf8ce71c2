"""The steps from surfaces to a prediction: one function behind each command."""

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from physgnn.dataset import (
    SOLVERS,
    Generation,
    Preset,
    Store,
    generate,
    verify,
)
from physgnn.dataset.generate import DEFAULT_SOLVER, check_febio
from physgnn.dataset.presets import find_preset
from physgnn.errors import InputError
from physgnn.geometry import (
    Rule,
    Surface,
    TetMesh,
    check_nested,
    check_quality,
    check_surface,
    select,
    tetrahedralize,
)
from physgnn.io.febio_run import find_febio
from physgnn.progress import Progress

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.learning.checkpoint import Checkpoint
    from physgnn.learning.training_config import TrainingConfig
    from physgnn.prediction.prediction import Prediction

Log = Callable[[str], None]


def mesh_surfaces(
    brain: Surface,
    tumours: Sequence[Surface] = (),
    *,
    rules: Mapping[str, Rule] | None = None,
    quality_floor: float | None = None,
    log: Log = lambda _: None,
    **size: Any,
) -> TetMesh:
    """Check surfaces, fill them with tetrahedra, and name the point sets.

    Parameters
    ----------
    brain, tumours : Surface
        In mm; small faults are mended, and said.
    rules : mapping of str to rule
        Point sets by name.
    quality_floor : float, optional
        See `physgnn.geometry.check_quality`.
    log : callable
        Told what was mended, and the mesh's size and quality.
    **size
        ``max_volume_mm3`` or ``target_points``; by default the published rule.

    Raises
    ------
    InputError
        If a surface cannot be meshed, a rule selects nothing, or a cell is too flat.
    """
    checked = []
    for i, surface in enumerate([brain, *tumours]):
        name = "brain" if i == 0 else f"tumour {i}"
        surface, mended = check_surface(surface, name)
        checked.append(surface)
        for line in mended:
            log(line)
    check_nested(checked[0], checked[1:])
    mesh = tetrahedralize(checked[0], checked[1:], log=log, **size)
    floor = {} if quality_floor is None else {"floor": quality_floor}
    log(str(check_quality(mesh, **floor)))
    sets = {name: select(mesh, rule) for name, rule in (rules or {}).items()}
    for name, ids in sets.items():
        log(f"point set '{name}': {len(ids)} points")
    return mesh.with_point_sets(**sets)


def simulate(
    mesh: TetMesh,
    preset: str | Preset,
    store: str | Path,
    *,
    solver: str = DEFAULT_SOLVER,
    workers: int = 1,
    scheduler: str | None = None,
    source: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> tuple[Store, Generation]:
    """Solve the load paths of a preset on a mesh; a second call resumes.

    A sample of the levels is checked, see `physgnn.dataset.verification`.

    Parameters
    ----------
    mesh : TetMesh
        The mesh.
    preset : str or Preset
        A row of ``PRESETS``, or a preset of the user's own.
    store : path
        Where the dataset is or is to be.
    solver : str
        A row of ``SOLVERS``.
    workers, scheduler, progress
        See `physgnn.dataset.generate`.
    source : mapping, optional
        Where mesh and loads come from, for the record; what JSON can hold.

    Raises
    ------
    InputError
        If preset, mesh, solver and store do not fit each other.
    """
    if solver not in SOLVERS:
        raise InputError(f"no solver '{solver}' (there are: {', '.join(SOLVERS)})")
    if solver == "febio" and scheduler is None:
        find_febio()
    name = preset if isinstance(preset, str) else "custom"
    if isinstance(preset, str):
        preset = find_preset(preset)
    mesh, paths = preset.on(mesh)
    if solver == "febio":
        check_febio(preset.element, paths)
    opened = Store.resume(
        store,
        mesh,
        paths,
        materials=preset.materials,
        fixed=mesh.point_set("fixed"),
        element=preset.element,
        provenance={
            "preset": name,
            "solver": solver,
            "physgnn": version("physgnn"),
            **(source or {}),
        },
    )
    before = opened.provenance.get("solver", DEFAULT_SOLVER)
    if before != solver:
        raise InputError(
            f"store {store} was begun with --solver {before}: go on with that, or name "
            "another store"
        )
    where: dict[str, Any] = {"workers": workers, "scheduler": scheduler}
    did = generate(opened, progress=progress, **where)
    verify(opened, progress=progress, **where)
    return opened, did


def train(
    store: str | Path,
    split: str,
    config: "TrainingConfig",
    run: str | Path,
    *,
    progress: Progress | None = None,
    **options: Any,
) -> "Checkpoint":
    """Train on a split of a dataset and calibrate the error bounds.

    Parameters
    ----------
    store, run : path
        The dataset, and the folder to train into.
    split : str
        A row of ``SPLITS``.
    config : TrainingConfig
        How to train.
    progress, **options
        See `physgnn.learning.train`.
    """
    from physgnn.evaluation.run import named_split
    from physgnn.learning.training import is_first_process
    from physgnn.learning.training import train as train_network
    from physgnn.prediction.predictor import calibrate_run

    # Training keeps what it read in a file: the store needn't keep it too.
    opened = Store.open(store, cache_bytes=128 * 2**20)
    parts = named_split(split, opened)
    checkpoint = train_network(opened, parts, config, run, progress=progress, **options)
    if is_first_process():
        calibrate_run(run, opened, parts, progress=progress)
    return checkpoint


def store_of(run: str | Path) -> Path:
    """Return the dataset a run was trained on, as its record names it."""
    try:
        record = json.loads((Path(run) / "run.json").read_text("utf-8"))
        return Path(record["data"]["path"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"{run} is no run folder: it has no readable run.json; train one, or name "
            "the dataset with --store"
        ) from error


def predict(
    run: str | Path,
    load: str | Path,
    out: str | Path,
    *,
    tolerance_mm: float | None = None,
    linear: bool = False,
) -> "Prediction":
    """Answer a load case from a JSON file and write the mesh with its displacement.

    Parameters
    ----------
    run : path
        Folder of a trained model.
    load, out : path
        JSON in, VTU out.
    tolerance_mm : float, optional
        See `physgnn.prediction.Predictor`.
    linear : bool
        Write the linear solution beside the prediction.
    """
    from physgnn.io import read_load_case, write_prediction
    from physgnn.prediction.linear import linear_answer
    from physgnn.prediction.predictor import Predictor

    predictor = Predictor.load(run)
    body = predictor.body
    case = read_load_case(load, body.mesh)
    prediction = predictor(case, tolerance_mm=tolerance_mm)
    fields = {"displacement_mm": prediction.displacement}
    if linear:
        fields["linear_displacement_mm"] = linear_answer(body)(case)
    fields["force_n"] = case.on_points(body.mesh.n_points)
    write_prediction(out, body.mesh, fields)
    return prediction


def published_difference(
    weights: str | Path, golden: str | Path, *, configuration: int, dataset: int
) -> float:
    """Return how far published weights are from a stored forward pass, mm.

    Parameters
    ----------
    weights : path
        A published state dict.
    golden : path
        An .npz of ``points``, ``cells``, ``region``, inputs ``x_<dataset>`` and outputs
        ``y_<dataset>_<configuration>``.
    configuration, dataset : int
        Which of the published networks it is.

    Returns
    -------
    float
        The largest distance over all points.
    """
    import torch

    from physgnn.learning.graph import Graph
    from physgnn.learning.published import load_published

    network = load_published(weights, configuration, dataset)
    names = (
        "points",
        "cells",
        "region",
        f"x_{dataset}",
        f"y_{dataset}_{configuration}",
    )
    points, cells, region, x, y = _arrays(Path(golden), names)
    graph = Graph.from_mesh(TetMesh(points, cells, region))
    with torch.inference_mode():
        answer = network(torch.from_numpy(x), graph).numpy()
    return float(np.linalg.norm(answer - y, axis=1).max())


def _arrays(path: Path, names: Sequence[str]) -> list[np.ndarray[Any, Any]]:
    try:
        with np.load(path, allow_pickle=False) as data:
            return [data[name] for name in names]
    except (OSError, ValueError, KeyError) as error:
        raise InputError(
            f"{path} must be an .npz file with {', '.join(names)} ({error})"
        ) from error


def command_line() -> str:
    """Return what the user typed, for the record."""
    return " ".join(["physgnn", *sys.argv[1:]])

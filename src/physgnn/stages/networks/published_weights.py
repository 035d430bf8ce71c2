"""The published weights, against a stored forward pass of them if there is one."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from physgnn.bundled import BUNDLED_RUN
from physgnn.errors import InputError
from physgnn.geometry import TetMesh
from physgnn.stages.outputs import FOLDER, writes

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.learning.physgnn.network import PhysGNN


@writes(out=FOLDER)
def published(
    weights: str | Path,
    golden: str | Path | None = None,
    *,
    configuration: int = 3,
    dataset: int = 2,
    store: str | Path | None = None,
    out: str | Path | None = None,
) -> float | None:
    """Load published weights and return how far they are from a stored forward pass.

    Without one it is checked that the file holds all the weights of a published
    PhysGNN, that they are finite, and that the network's output on the bundled brain
    is. Which configuration and dataset they are of cannot be told from the file: all
    twelve networks have the same shapes.

    Parameters
    ----------
    weights : path
        A published state dict.
    golden : path, optional
        An .npz of ``points``, ``cells``, ``region``, inputs ``x_<dataset>`` and outputs
        ``y_<dataset>_<configuration>``.
    configuration, dataset : int
        Which of the published networks it is.
    store, out : path, optional
        Save the network as a run on this dataset, with its load normalised by the
        dataset: to evaluate there, or to begin a training with. It was fitted to
        another mesh, and its far field is of that mesh.

    Returns
    -------
    float or None
        The largest distance over all points, mm; None if there is nothing to compare
        with.

    Raises
    ------
    InputError
        If a file cannot be used, weights or output are not finite, or one of store and
        out is given without the other.
    """
    import torch

    from physgnn.learning.graph import Graph
    from physgnn.learning.physgnn.published import load_published

    if (store is None) != (out is None):
        raise InputError(
            "a run of published weights takes both a dataset, --store, and a folder, "
            "--out"
        )
    network = load_published(weights, configuration, dataset)
    _check_finite(network, Path(weights))
    if store is not None and out is not None:
        options = {"configuration": configuration, "dataset": dataset}
        _save_run(network, options, Path(store), Path(out))
    if golden is None:
        return None
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
        output = network(torch.from_numpy(x), graph).numpy()
    return float(np.linalg.norm(output - y, axis=1).max())


def _save_run(
    network: "PhysGNN", options: dict[str, int], store_path: Path, out: Path
) -> None:
    """Save the network as a run, judged on validation samples of the dataset."""
    from dataclasses import asdict

    from physgnn.dataset import Store, named_split
    from physgnn.learning.models import build_model
    from physgnn.learning.runs.checkpoint import Checkpoint
    from physgnn.learning.runs.record import new_record, with_places, with_result
    from physgnn.learning.training.config import TrainingConfig
    from physgnn.learning.training.resumption.resuming import prepare
    from physgnn.learning.training.training_run import judged

    store = Store.open(store_path)
    split = named_split("published", store)
    config = TrainingConfig(options={**options, "normaliser": "published"})
    record = with_places(new_record([(store, split)], asdict(config)), out, [store])
    model = build_model(config.model, store.body, **config.options)
    model.fit(store, split.train)
    weights = {f"network.{k}": v.numpy() for k, v in network.state_dict().items()}
    model.restore({**model.arrays(), **weights})
    prepare(out, record)
    loss = judged(model, store, split, config.loss)
    untrained = {"wall": 0.0, "processor": 0.0}
    Checkpoint(model, with_result(record, loss=loss, spent=untrained)).save(out)


def _check_finite(network: "PhysGNN", weights: Path) -> None:
    """Raise InputError unless the output on the unloaded bundled brain is finite."""
    import torch

    from physgnn.io import read_mesh
    from physgnn.learning.graph import Graph
    from physgnn.learning.runs.folder import RunFolder

    mesh = read_mesh(RunFolder(BUNDLED_RUN).case)
    x = torch.zeros((mesh.n_points, 7))
    x[:, 0] = 1.0  # brain, without a force
    with torch.inference_mode():
        output = network(x, Graph.from_mesh(mesh))
    if not bool(torch.isfinite(output).all()):
        raise InputError(
            f"{weights} holds the shapes of a published PhysGNN, but its output is not "
            "finite: the file is damaged, or of another network"
        )


def _arrays(path: Path, names: Sequence[str]) -> list[np.ndarray[Any, Any]]:
    try:
        with np.load(path, allow_pickle=False) as data:
            return [data[name] for name in names]
    except (OSError, ValueError, KeyError) as error:
        raise InputError(
            f"{path} must be an .npz file with {', '.join(names)} ({error})"
        ) from error

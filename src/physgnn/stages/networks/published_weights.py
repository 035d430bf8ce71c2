"""The published weights against a stored forward pass of them."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry import TetMesh


def published(
    weights: str | Path,
    golden: str | Path,
    *,
    configuration: int = 3,
    dataset: int = 2,
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
    from physgnn.learning.physgnn.published import load_published

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
        output = network(torch.from_numpy(x), graph).numpy()
    return float(np.linalg.norm(output - y, axis=1).max())


def _arrays(path: Path, names: Sequence[str]) -> list[np.ndarray[Any, Any]]:
    try:
        with np.load(path, allow_pickle=False) as data:
            return [data[name] for name in names]
    except (OSError, ValueError, KeyError) as error:
        raise InputError(
            f"{path} must be an .npz file with {', '.join(names)} ({error})"
        ) from error

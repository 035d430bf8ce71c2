"""The published weights, against a stored forward pass of them if there is one."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from physgnn.bundled import BUNDLED_RUN
from physgnn.errors import InputError
from physgnn.geometry import TetMesh

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.learning.physgnn.network import PhysGNN


def published(
    weights: str | Path,
    golden: str | Path | None = None,
    *,
    configuration: int = 3,
    dataset: int = 2,
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

    Returns
    -------
    float or None
        The largest distance over all points, mm; None if there is nothing to compare
        with.

    Raises
    ------
    InputError
        If a file cannot be used, or weights or output are not finite.
    """
    import torch

    from physgnn.learning.graph import Graph
    from physgnn.learning.physgnn.published import load_published

    network = load_published(weights, configuration, dataset)
    if golden is None:
        _check_finite(network, Path(weights))
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

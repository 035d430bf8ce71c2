"""PhysGNN as published (PyTorch Geometric) against ours, taking turns in one process.

    python benchmarks/physgnn_forward.py ../shared/paper --threads 2 --repeats 5

The folder holds the published weights and ``golden_forward.npz`` (a mesh, inputs and
the outputs expected of them). Prints medians, and how far the outputs are apart;
the last row is ours with ``precision="bfloat16"`` against the published in float32.
"""

import argparse
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph
from physgnn.learning.losses import mean_euclidean
from physgnn.learning.precision import set_precision
from physgnn.learning.published import load_published

sys.path.append(str(Path(__file__).parents[1] / "tests"))
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from learning.reference import reference_of

# Dataset: best configuration, published batch size.
CASES = {1: (9, 4), 2: (3, 8)}


def medians(functions: list[Callable[[], object]], repeats: int) -> list[float]:
    """Return each function's median wall-clock time in s; they take turns."""
    seconds: list[list[float]] = [[] for _ in functions]
    for _ in range(repeats):
        for function, values in zip(functions, seconds, strict=True):
            start = time.perf_counter()
            function()
            values.append(time.perf_counter() - start)
    return [float(np.median(values)) for values in seconds]


def batch_of(x: Tensor, size: int) -> Tensor:
    """Return the sample ``size`` times, its standardised forces scaled."""
    batch = x.repeat(size, 1, 1)
    loaded = (x[:, 1:] != x[0, 1:]).any(dim=1)
    batch[:, loaded, 1:] *= torch.linspace(0.5, 1.0, size)[:, None, None]
    return batch


def compare(folder: Path, dataset: int, repeats: int) -> None:
    configuration, batch_size = CASES[dataset]
    golden = np.load(folder / "golden_forward.npz")
    graph = Graph.from_mesh(
        TetMesh(golden["points"], golden["cells"], golden["region"])
    )
    weights = folder / f"config{configuration}_dataset{dataset}.pt"
    ours = load_published(weights, configuration=configuration, dataset=dataset)
    theirs = reference_of(ours, configuration, dataset)
    sample = torch.from_numpy(golden[f"x_{dataset}"])[None]
    batch = batch_of(sample[0], batch_size)
    edges = graph.edge_index

    def step(network: Callable[[Tensor], Tensor]) -> None:
        mean_euclidean(network(batch), torch.zeros(*batch.shape[:2], 3)).backward()

    def published(x: Tensor) -> Tensor:
        return torch.stack([theirs(s, edges, graph.weight) for s in x])

    def shared(x: Tensor) -> Tensor:
        return ours(x, graph)

    with torch.inference_mode():
        exact = shared(sample)
        apart = float((exact - published(sample)).abs().max())
        forward = medians([lambda: published(sample), lambda: shared(sample)], repeats)
        set_precision(ours, "bfloat16")
        rounding = float((shared(sample) - exact).norm(dim=-1).mean())
        rough = medians([lambda: shared(sample)], repeats)
        set_precision(ours, "float32")
    step(published)
    step(shared)
    print(
        f"configuration {configuration}, dataset {dataset}: outputs {apart:.1e} mm "
        f"apart, gradients {gradients_apart(ours, theirs.our_gradients()):.1e} of the "
        "largest"
    )
    print_row("forward, 1 sample", forward, 1)
    print_row(f"the same, bfloat16 ({rounding:.4f} mm off)", forward[:1] + rough, 1)
    training = medians([lambda: step(published), lambda: step(shared)], repeats)
    print_row(f"training step, batch {batch_size}, a sample", training, batch_size)


def gradients_apart(network: nn.Module, expected: dict[str, Tensor]) -> float:
    """Return the largest difference over the largest gradient."""
    scale = max(float(gradient.abs().max()) for gradient in expected.values())
    differences = (
        (parameter.grad - expected[name]).abs().max()
        for name, parameter in network.named_parameters()
    )
    return max(float(difference) for difference in differences) / scale


def print_row(what: str, seconds: list[float], samples: int) -> None:
    theirs, ours = (value / samples for value in seconds)
    print(f"  {what:<38}{theirs:9.3f} s {ours:9.3f} s {theirs / ours:7.1f} times")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--datasets", type=int, nargs="+", default=list(CASES))
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    print(f"{'':40}{'published':>11} {'ours':>11} {'faster':>9}")
    for dataset in options.datasets:
        compare(options.folder, dataset, options.repeats)


if __name__ == "__main__":
    main()

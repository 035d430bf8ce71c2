"""PhysGNN as published (PyTorch Geometric) against ours, taking turns in one process.

    python benchmarks/physgnn_forward.py ../shared/paper --threads 2 --repeats 5

The folder holds the published weights and ``golden_forward.npz`` (a mesh, inputs and
the outputs expected of them). Prints medians, and how far the outputs are apart.
The published network takes a batch one sample after another, so it is timed on one.
Each dataset has a process of its own, forward passes before training steps: what was
computed before decides how much memory the process already has, and fresh memory is
half of the published network's time.
On a busy machine, ``--threads 1 --processor-time`` counts only what the process gets.
"""

import argparse
import sys
import time
import warnings
from collections.abc import Callable
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph
from physgnn.learning.losses import mean_euclidean
from physgnn.learning.precision import set_precision
from physgnn.learning.published import load_published
from physgnn.learning.threads import only_side_by_side
from physgnn.learning.workspace import reused_memory

sys.path.append(str(Path(__file__).parents[1] / "tests"))
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from learning.reference import reference_of

Clock = Callable[[], float]

# Dataset: best configuration, published batch size.
CASES = {1: (9, 4), 2: (3, 8)}


def medians(
    functions: list[Callable[[], object]],
    repeats: int,
    clock: Clock = time.perf_counter,
) -> list[float]:
    """Return each function's median time in s; they take turns."""
    seconds: list[list[float]] = [[] for _ in functions]
    for _ in range(repeats):
        for function, values in zip(functions, seconds, strict=True):
            start = clock()
            function()
            values.append(clock() - start)
    return [float(np.median(values)) for values in seconds]


def batch_of(x: Tensor, size: int) -> Tensor:
    """Return the sample ``size`` times, its standardised forces scaled."""
    batch = x.repeat(size, 1, 1)
    loaded = (x[:, 1:] != x[0, 1:]).any(dim=1)
    batch[:, loaded, 1:] *= torch.linspace(0.5, 1.0, size)[:, None, None]
    return batch


def compare(folder: Path, dataset: int, options: argparse.Namespace) -> None:
    torch.set_num_threads(options.threads)
    clock = time.process_time if options.processor_time else time.perf_counter
    repeats = options.repeats
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

    def step(network: Callable[[Tensor], Tensor], n: int) -> None:
        mean_euclidean(
            network(batch[:n]), torch.zeros(n, *batch.shape[1:2], 3)
        ).backward()

    def our_step() -> None:
        with only_side_by_side():  # as training does
            step(shared, batch_size)

    def published(x: Tensor) -> Tensor:
        return torch.stack([theirs(s, edges, graph.weight) for s in x])

    def shared(x: Tensor) -> Tensor:
        return ours(x, graph)

    with torch.inference_mode():
        exact = shared(sample)
        apart = float((exact - published(sample)).abs().max())
        both = [lambda: published(sample), lambda: shared(sample)]
        forward = medians(both, repeats, clock)
        set_precision(ours, "bfloat16")
        rounding = float((shared(sample) - exact).norm(dim=-1).mean())
        rough = medians([lambda: shared(sample)], repeats, clock)
        set_precision(ours, "float32")
    step(published, 2)
    step(shared, 2)
    print(
        f"configuration {configuration}, dataset {dataset}: outputs {apart:.1e} mm "
        f"apart, gradients {gradients_apart(ours, theirs.our_gradients()):.1e} of the "
        "largest"
    )
    print_row("forward, 1 sample", forward)
    print_row(f"the same, bfloat16 ({rounding:.4f} mm off)", forward[:1] + rough)
    steps = [lambda: step(published, 1), our_step]
    with reused_memory():
        one, all_of_them = medians(steps, repeats, clock)
        set_precision(ours, "bfloat16")
        (rough_step,) = medians(steps[1:], repeats, clock)
    what = f"training step, batch {batch_size}, a sample"
    print_row(what, [one, all_of_them / batch_size])
    print_row("the same, bfloat16", [one, rough_step / batch_size])


def gradients_apart(network: nn.Module, expected: dict[str, Tensor]) -> float:
    """Return the largest difference over the largest gradient."""
    scale = max(float(gradient.abs().max()) for gradient in expected.values())
    differences = (
        (parameter.grad - expected[name]).abs().max()
        for name, parameter in network.named_parameters()
    )
    return max(float(difference) for difference in differences) / scale


def print_row(what: str, seconds: list[float]) -> None:
    theirs, ours = seconds
    print(f"  {what:<38}{theirs:9.3f} s {ours:9.3f} s {theirs / ours:7.1f} times")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--datasets", type=int, nargs="+", default=list(CASES))
    parser.add_argument("--processor-time", action="store_true")
    options = parser.parse_args()
    print(f"{'':40}{'published':>11} {'ours':>11} {'faster':>9}", flush=True)
    for dataset in options.datasets:
        of_its_own = get_context("spawn").Process(
            target=compare, args=(options.folder, dataset, options)
        )
        of_its_own.start()
        of_its_own.join()
        if of_its_own.exitcode:
            sys.exit(of_its_own.exitcode)


if __name__ == "__main__":
    main()

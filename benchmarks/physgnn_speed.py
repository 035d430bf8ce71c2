"""PhysGNN as published (PyTorch Geometric) against ours, taking turns in one process.

    python benchmarks/physgnn_speed.py ../shared/paper --threads 2 --repeats 5

The folder holds the published weights and ``golden_forward.npz`` (a mesh, inputs and
the outputs expected of them). Prints medians, and how far the outputs are apart.
The published network takes a batch one sample after another, so it is timed on one.
Each dataset has a process of its own, forward passes before training steps: what was
computed before decides how much memory the process already has, and fresh memory is
half of the published network's time.
On a busy machine, ``--threads 1 --processor-time`` counts only what the process gets.
(A file ``benchmarks/physgnn.py`` would hide the package from every benchmark.)
"""

import argparse
import sys
import time
import warnings
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph
from physgnn.learning.losses import mean_euclidean
from physgnn.learning.physgnn import PhysGNN
from physgnn.learning.precision import set_precision
from physgnn.learning.published import load_published
from physgnn.learning.threads import only_side_by_side
from physgnn.learning.workspace import reused_memory

sys.path.append(str(Path(__file__).parents[1] / "tests"))
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from learning.reference import ReferencePhysGNN, reference_of

Clock = Callable[[], float]
Network = Callable[[Tensor], Tensor]

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


@dataclass(frozen=True)
class Pair:
    """The published network and ours, exact and rounded, and what to give them."""

    ours: PhysGNN
    rough: PhysGNN
    theirs: ReferencePhysGNN
    graph: Graph
    edges: Tensor
    sample: Tensor
    batch: Tensor

    @classmethod
    def read(cls, folder: Path, dataset: int) -> "Pair":
        """Load a dataset's published weights into both."""
        configuration, batch_size = CASES[dataset]
        golden = np.load(folder / "golden_forward.npz")
        mesh = TetMesh(golden["points"], golden["cells"], golden["region"])
        weights = folder / f"config{configuration}_dataset{dataset}.pt"
        ours = load_published(weights, configuration=configuration, dataset=dataset)
        rough = deepcopy(ours)
        set_precision(rough, "bfloat16")
        theirs = reference_of(ours, configuration, dataset)
        graph = Graph.from_mesh(mesh)
        sample = torch.from_numpy(golden[f"x_{dataset}"])
        batch = batch_of(sample, batch_size)
        return cls(ours, rough, theirs, graph, graph.edge_index, sample[None], batch)

    def published(self, x: Tensor) -> Tensor:
        """Return what the published network makes of each sample, one after another."""
        weight = self.graph.weight
        return torch.stack([self.theirs(sample, self.edges, weight) for sample in x])

    def shared(self, x: Tensor) -> Tensor:
        """Return what ours makes of them together."""
        return self.ours(x, self.graph)

    def rounded(self, x: Tensor) -> Tensor:
        """Return the same in bfloat16."""
        return self.rough(x, self.graph)


def step(network: Network, batch: Tensor) -> None:
    zeros = torch.zeros(*batch.shape[:2], 3)
    mean_euclidean(network(batch), zeros).backward()


def step_as_in_training(network: Network, batch: Tensor) -> None:
    with only_side_by_side():
        step(network, batch)


def compare(folder: Path, dataset: int, options: argparse.Namespace) -> None:
    torch.set_num_threads(options.threads)
    clock = time.process_time if options.processor_time else time.perf_counter
    pair = Pair.read(folder, dataset)
    time_forward(pair, dataset, options.repeats, clock)
    time_steps(pair, options.repeats, clock)


def time_forward(pair: Pair, dataset: int, repeats: int, clock: Clock) -> None:
    passes = [pair.published, pair.shared, pair.rounded]
    with torch.inference_mode():
        expected, exact, rounded = (one(pair.sample) for one in passes)
        apart = float((exact - expected).abs().max())
        off = float((rounded - exact).norm(dim=-1).mean())
        calls = [partial(one, pair.sample) for one in passes]
        theirs, ours, rough = medians(calls, repeats, clock)
    print(f"dataset {dataset}: outputs {apart:.1e} mm apart")
    print_row("forward, 1 sample", theirs, ours)
    print_row(f"the same, bfloat16 ({off:.4f} mm off)", theirs, rough)


def time_steps(pair: Pair, repeats: int, clock: Clock) -> None:
    batch, size = pair.batch, len(pair.batch)
    step(pair.published, batch[:2])
    step(pair.shared, batch[:2])
    apart = gradients_apart(pair.ours, pair.theirs.our_gradients())
    print(f"gradients {apart:.1e} of the largest apart")
    steps = [
        partial(step, pair.published, batch[:1]),
        partial(step_as_in_training, pair.shared, batch),
        partial(step_as_in_training, pair.rounded, batch),
    ]
    with reused_memory():
        theirs, ours, rough = medians(steps, repeats, clock)
    print_row(f"training step, batch {size}, a sample", theirs, ours / size)
    print_row("the same, bfloat16", theirs, rough / size)


def gradients_apart(network: nn.Module, expected: dict[str, Tensor]) -> float:
    """Return the largest difference over the largest gradient."""
    scale = max(float(gradient.abs().max()) for gradient in expected.values())
    differences = (
        (parameter.grad - expected[name]).abs().max()
        for name, parameter in network.named_parameters()
    )
    return max(float(difference) for difference in differences) / scale


def print_row(what: str, theirs: float, ours: float) -> None:
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

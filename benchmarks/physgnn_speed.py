"""PhysGNN as published (PyTorch Geometric) against ours, taking turns.

    python benchmarks/physgnn_speed.py ../shared/paper --threads 2 --repeats 5

The folder holds the published weights and ``golden_forward.npz`` (a mesh, inputs and
the outputs expected of them). Prints medians, and how far the outputs are apart.
The published network takes a batch one sample after another, so it is timed on one.
Each has a process of its own, so that what one leaves in memory costs the other
nothing, and a turn is two calls, of which the second is timed.
On a busy machine, ``--threads 1 --processor-time`` counts only what the process gets.
(A file ``benchmarks/physgnn.py`` would hide the package from every benchmark.)
"""

import argparse
import sys
import time
import warnings
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.cpu import only_side_by_side
from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.precision import set_precision
from physgnn.learning.physgnn.published import load_published
from physgnn.learning.training.objective.losses import mean_euclidean

sys.path.append(str(Path(__file__).parents[1] / "tests"))
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from learning.reference import reference_of

Array = NDArray[np.float32]
Clock = Callable[[], float]

# Dataset: best configuration, published batch size.
CASES = {1: (9, 4), 2: (3, 8)}


def medians(timings: list[Callable[[], float]], repeats: int) -> list[float]:
    """Return the median of each one's seconds; they take turns."""
    seconds = [[timing() for timing in timings] for _ in range(repeats)]
    return [float(np.median(values)) for values in zip(*seconds, strict=True)]


def second_call(call: Callable[[], object], clock: Clock = time.perf_counter) -> float:
    """Return the seconds of a call that follows another."""
    call()
    start = clock()
    call()
    return clock() - start


def batch_of(x: Tensor, size: int) -> Tensor:
    """Return the sample ``size`` times, its standardised forces scaled."""
    batch = x.repeat(size, 1, 1)
    loaded = (x[:, 1:] != x[0, 1:]).any(dim=1)
    batch[:, loaded, 1:] *= torch.linspace(0.5, 1.0, size)[:, None, None]
    return batch


class Ours:
    """Our network with the published weights, and what to give it."""

    def __init__(
        self, dataset: int, given: argparse.Namespace, precision: str = "float32"
    ) -> None:
        torch.set_num_threads(given.threads)
        self.clock = time.process_time if given.processor_time else time.perf_counter
        configuration, batch_size = CASES[dataset]
        golden = np.load(given.folder / "golden_forward.npz")
        mesh = TetMesh(golden["points"], golden["cells"], golden["region"])
        weights = given.folder / f"config{configuration}_dataset{dataset}.pt"
        self.network = load_published(
            weights, configuration=configuration, dataset=dataset
        )
        set_precision(self.network, precision)
        self.graph = Graph.from_mesh(mesh)
        self.sample = torch.from_numpy(golden[f"x_{dataset}"])
        self.batch = batch_of(self.sample, batch_size)

    def forward(self, x: Tensor) -> Tensor:
        """Return displacement of each sample."""
        return self.network(x, self.graph)

    def step(self, batch: Tensor) -> None:
        """Add to the gradients."""
        zeros = torch.zeros(*batch.shape[:2], 3)
        mean_euclidean(self.forward(batch), zeros).backward()

    def outputs(self) -> Array:
        """Return the sample's displacement, mm."""
        with torch.inference_mode():
            return self.forward(self.sample[None])[0].numpy()

    def gradients(self) -> dict[str, Array]:
        """Return the gradients by two samples."""
        self.step(self.batch[:2])
        return {name: w.grad.numpy() for name, w in self.network.named_parameters()}

    def forward_seconds(self) -> float:
        """Time a forward pass."""
        with torch.inference_mode():
            return second_call(partial(self.forward, self.sample[None]), self.clock)

    def step_seconds(self) -> float:
        """Time a training step as in training, a sample."""
        with only_side_by_side():
            seconds = second_call(partial(self.step, self.batch), self.clock)
        return seconds / len(self.batch)


class Published(Ours):
    """The published network with the published weights."""

    def __init__(self, dataset: int, given: argparse.Namespace) -> None:
        super().__init__(dataset, given)
        self.edges = self.graph.edge_index
        self.theirs = reference_of(self.network, CASES[dataset][0], dataset)

    def forward(self, x: Tensor) -> Tensor:
        """Return displacement of each sample, one after another."""
        weight = self.graph.weight
        return torch.stack([self.theirs(sample, self.edges, weight) for sample in x])

    def gradients(self) -> dict[str, Array]:
        """Return the gradients by two samples, by our parameters' names."""
        self.step(self.batch[:2])
        of_theirs = self.theirs.our_gradients()
        return {name: gradient.numpy() for name, gradient in of_theirs.items()}

    def step_seconds(self) -> float:
        """Time a training step of one sample."""
        return second_call(partial(self.step, self.batch[:1]), self.clock)


SIDES: dict[str, Callable[..., Ours]] = {
    "published": Published,
    "ours": Ours,
    "bfloat16": partial(Ours, precision="bfloat16"),
}
_side: list[Ours] = []  # of this process


def begin(name: str, dataset: int, given: argparse.Namespace) -> None:
    _side[:] = [SIDES[name](dataset, given)]


def ask(what: str) -> Any:
    return getattr(_side[0], what)()


def compare(dataset: int, given: argparse.Namespace) -> None:
    with ExitStack() as stack:
        asked = [
            partial(stack.enter_context(process_of(name, dataset, given)).submit, ask)
            for name in SIDES
        ]

        def results(what: str) -> list[Any]:
            return [ask_it(what).result() for ask_it in asked]

        def seconds(what: str) -> list[float]:
            timings = [lambda ask_it=ask_it: ask_it(what).result() for ask_it in asked]
            return medians(timings, given.repeats)

        published, ours, rough = results("outputs")
        print(f"dataset {dataset}: outputs {abs(ours - published).max():.1e} mm apart")
        off = np.linalg.norm(rough - ours, axis=1).mean()
        print_rows("forward, 1 sample", seconds("forward_seconds"))
        print(f"  bfloat16 is {off:.4f} mm off")
        print(f"gradients {gradients_apart(*results('gradients')[:2]):.1e} apart")
        size = CASES[dataset][1]
        print_rows(f"training step, batch {size}, a sample", seconds("step_seconds"))


def process_of(
    name: str, dataset: int, given: argparse.Namespace
) -> ProcessPoolExecutor:
    context = get_context("spawn")
    return ProcessPoolExecutor(1, context, begin, (name, dataset, given))


def gradients_apart(theirs: dict[str, Array], ours: dict[str, Array]) -> float:
    """Return the largest difference over the largest gradient."""
    scale = max(abs(gradient).max() for gradient in theirs.values())
    return float(max(abs(ours[name] - theirs[name]).max() for name in ours) / scale)


def print_rows(what: str, seconds: list[float]) -> None:
    theirs, *others = seconds
    for name, ours in zip((what, "  the same, bfloat16"), others, strict=True):
        print(f"  {name:<38}{theirs:9.3f} s {ours:9.3f} s {theirs / ours:7.1f} times")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--datasets", type=int, nargs="+", default=list(CASES))
    parser.add_argument("--processor-time", action="store_true")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    add_arguments(parser)
    given = parser.parse_args()
    print(f"{'':40}{'published':>11} {'ours':>11} {'faster':>9}", flush=True)
    for dataset in given.datasets:
        compare(dataset, given)


if __name__ == "__main__":
    main()

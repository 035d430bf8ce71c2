"""What each family of PhysGNN's compiled kernels buys over plain PyTorch.

    python benchmarks/physgnn_kernels.py ../shared/paper --threads 1 --processor-time

Exact pruning stays on. A row is the network with one family of kernels replaced by
its plain PyTorch counterpart, or with all of them replaced. The networks take turns,
each in a process of its own, as in ``physgnn_speed.py``. Prints medians, how many
times slower each is than the network with all kernels, and how far outputs and
gradients are apart.
"""

import argparse
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack, nullcontext
from functools import partial
from multiprocessing import get_context
from typing import Any

import torch
from torch import Tensor
from torch.nn.functional import linear, prelu

import physgnn_speed
from physgnn.learning import aggregation, attention, convolution, physgnn
from physgnn.learning.graph import Graph
from physgnn.learning.threads import only_side_by_side
from physgnn.learning.workspace import reused_memory
from physgnn_speed import CASES, Ours, gradients_apart, medians

FORWARD_PASSES = 3


def sparse_aggregate(
    graph: Graph, x: Tensor, *, weighted: bool, aggregation: str
) -> Tensor:
    """Multiply by a sparse matrix, with a maximum instead of the sum if wanted."""
    neighbours = graph.weighted if weighted else graph.plain
    if not hasattr(neighbours.graph, "matrix"):
        shape = graph.n_points, graph.n_columns
        with torch.inference_mode(False):
            matrix = torch.sparse_csr_tensor(
                graph.row_start.clone(),
                graph.column.clone(),
                neighbours.value.clone(),
                shape,
            )
        object.__setattr__(neighbours.graph, "matrix", matrix)
    matrix = neighbours.graph.matrix
    reduction = {"add": "sum", "max": "amax"}[aggregation]
    return torch.stack([torch.sparse.mm(matrix, sample, reduction) for sample in x])


def scatter_aggregate(
    graph: Graph, x: Tensor, *, weighted: bool, aggregation: str
) -> Tensor:
    """Gather a message an edge and scatter them."""
    neighbours = graph.weighted if weighted else graph.plain
    return scattered(neighbours, x, aggregation)


def plain_dense(
    inputs: Sequence[Tensor], matrices: Sequence[Tensor], bias: Tensor, slope: Tensor
) -> Tensor:
    """Apply linear layers and PReLU one after the other."""
    first, *others = zip(inputs, matrices, strict=True)
    z = linear(*first, bias)
    for x, matrix in others:
        z = z + linear(x, matrix)
    return prelu(z.flatten(0, 1), slope).view_as(z)


def plain_scores(
    self: attention.JumpingKnowledge,
    layers: Sequence[Tensor],
    common: Sequence[Tensor] | None,
) -> Tensor:
    """Read the rows with torch.nn.LSTM."""
    rows = torch.stack([x.flatten(0, 1) for x in attention._whole(layers, common)])
    scores = linear(self.lstm(rows)[0], self.score.weight)
    return scores.view(len(layers), *layers[-1].shape[:2])


def batch_first_scores(
    self: attention.JumpingKnowledge,
    layers: Sequence[Tensor],
    common: Sequence[Tensor] | None,
) -> Tensor:
    """Read the rows with torch.nn.LSTM, a row's steps side by side in memory."""
    whole = attention._whole(layers, common)
    rows = torch.stack([x.flatten(0, 1) for x in whole], dim=1)
    self.lstm.batch_first = True
    scores = linear(self.lstm(rows)[0], self.score.weight)[..., 0]
    return scores.t().reshape(len(layers), *whole[-1].shape[:2])


def plain_mean(weight: Tensor, layers: Sequence[Tensor]) -> Tensor:
    """Multiply and add up."""
    return (weight[..., None] * torch.stack(list(layers))).sum(0)


scattered = aggregation.scattered


def replace(*places: tuple[Any, str, Any]) -> Callable[[], None]:
    def act() -> None:
        for module, name, value in places:
            setattr(module, name, value)

    return act


PLAIN: Mapping[str, Callable[[], None]] = {
    "neighbours": replace((convolution, "aggregate", sparse_aggregate)),
    "neighbours (scatter)": replace((convolution, "aggregate", scatter_aggregate)),
    "dense layers": replace(
        (convolution, "dense", plain_dense), (physgnn, "dense", plain_dense)
    ),
    "LSTM": replace((attention.JumpingKnowledge, "_scores", plain_scores)),
    "LSTM (batch first)": replace(
        (attention.JumpingKnowledge, "_scores", batch_first_scores)
    ),
    "mean of layers": replace((attention, "layer_mean", plain_mean)),
    "workspace": replace((physgnn, "keep_freed_memory", lambda: None)),
}
FAMILIES = ("neighbours", "dense layers", "LSTM", "mean of layers", "workspace")
VARIANTS: Mapping[str, Sequence[str]] = {
    "all kernels": (),
    **{f"plain {name}": (name,) for name in PLAIN},
    "plain dense, mean, workspace": ("dense layers", "mean of layers", "workspace"),
    "all plain": FAMILIES,
}


class Variant(Ours):
    """Our network with some families of kernels replaced."""

    def __init__(self, name: str, *given: Any) -> None:
        super().__init__(*given)
        self.fresh_memory = "workspace" in VARIANTS[name]
        for family in VARIANTS[name]:
            PLAIN[family]()

    def forward_seconds(self) -> float:
        """Time some forward passes; return one's seconds."""
        with torch.inference_mode():
            self.forward(self.sample[None])
            start = self.clock()
            for _ in range(FORWARD_PASSES):
                self.forward(self.sample[None])
        return (self.clock() - start) / FORWARD_PASSES

    def step_seconds(self) -> float:
        """Time a training step as in training, a sample."""
        memory = nullcontext() if self.fresh_memory else reused_memory()
        with memory, only_side_by_side():
            self.step(self.batch)
            start = self.clock()
            self.step(self.batch)
        return (self.clock() - start) / len(self.batch)


def begin(name: str, dataset: int, given: argparse.Namespace) -> None:
    physgnn_speed._side[:] = [Variant(name, dataset, given)]


def compare(dataset: int, given: argparse.Namespace) -> None:
    with ExitStack() as stack:
        ask = [
            partial(stack.enter_context(process).submit, physgnn_speed.ask)
            for process in (process_of(name, dataset, given) for name in given.variants)
        ]

        def answers(what: str) -> list[Any]:
            return [ask_it(what).result() for ask_it in ask]

        def seconds(what: str) -> list[float]:
            timings = [lambda ask_it=ask_it: ask_it(what).result() for ask_it in ask]
            return medians(timings, given.repeats)

        outputs, gradients = answers("outputs"), answers("gradients")
        forward = seconds("forward_seconds")
        step = seconds("step_seconds")
    print(f"dataset {dataset}, training batch {CASES[dataset][1]}")
    for k, name in enumerate(given.variants):
        print(
            f"  {name:<32}{forward[k]:8.3f} s {forward[k] / forward[0]:6.2f}"
            f"{step[k]:10.3f} s {step[k] / step[0]:6.2f}"
            f"{abs(outputs[k] - outputs[0]).max():12.1e} mm"
            f"{gradients_apart(gradients[0], gradients[k]):10.1e}",
            flush=True,
        )


def process_of(
    name: str, dataset: int, given: argparse.Namespace
) -> ProcessPoolExecutor:
    context = get_context("spawn")
    return ProcessPoolExecutor(1, context, begin, (name, dataset, given))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    physgnn_speed.add_arguments(parser)
    parser.add_argument("--variants", nargs="+", default=list(VARIANTS))
    given = parser.parse_args()
    heads = "forward, a sample", "training step, a sample", "outputs", "gradients"
    print(f"{'':34}{heads[0]:>17}{heads[1]:>25}{heads[2]:>12}{heads[3]:>11}")
    for dataset in given.datasets:
        compare(dataset, given)


if __name__ == "__main__":
    main()

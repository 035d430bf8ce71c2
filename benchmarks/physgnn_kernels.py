"""What PhysGNN's compiled LSTMs buy over torch.nn.LSTM, in both precisions.

    python benchmarks/physgnn_kernels.py ../shared/paper --threads 1 --processor-time

Everything else is the same, exact pruning included. For bfloat16, torch.nn.LSTM runs
under autocast. The networks take turns, each in a process of its own, as in
``physgnn_speed.py``. Prints medians, how many times as long plain PyTorch takes, and
how far outputs and gradients are from those of the compiled LSTMs in float32.
"""

import argparse
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from functools import partial
from multiprocessing import get_context
from typing import Any

import torch
from torch import Tensor

import physgnn_speed
from physgnn.learning.cpu import only_side_by_side
from physgnn.learning.physgnn.layers import jumping_knowledge as attention
from physgnn_speed import CASES, Ours, add_arguments, ask, gradients_apart, medians

PRECISIONS = ("float32", "bfloat16")
ROWS = [(precision, plain) for precision in PRECISIONS for plain in (False, True)]
FORWARD_PASSES = 3


class Variant(Ours):
    """Our network with compiled or with torch's LSTMs; calls once, then is timed."""

    def __init__(
        self, precision: str, plain: bool, dataset: int, given: argparse.Namespace
    ) -> None:
        super().__init__(dataset, given, precision)
        if plain:
            attention.compiled_for = lambda _: False
            if precision == "bfloat16":
                attention.JumpingKnowledge.scores = autocast_scores

    def forward_seconds(self) -> float:
        """Time some forward passes; return one's seconds."""
        with torch.inference_mode():
            call = partial(self.forward, self.sample[None])
            return self.seconds(call, FORWARD_PASSES) / FORWARD_PASSES

    def step_seconds(self) -> float:
        """Time a training step as in training, a sample."""
        with only_side_by_side():
            seconds = self.seconds(partial(self.step, self.batch), 1)
        return seconds / len(self.batch)

    def seconds(self, call: Callable[[], object], n_calls: int) -> float:
        """Return the seconds of calls that follow another."""
        call()
        start = self.clock()
        for _ in range(n_calls):
            call()
        return self.clock() - start


def autocast_scores(
    self: attention.JumpingKnowledge, layers: Sequence[Tensor]
) -> Tensor:
    sequences = torch.stack([layer.flatten(0, 1) for layer in layers])
    with torch.autocast("cpu", torch.bfloat16):
        hidden, _ = self.lstm(sequences)
    return self.score(hidden.float()).view(len(layers), *layers[0].shape[:2])


def begin(precision: str, plain: bool, dataset: int, given: argparse.Namespace) -> None:
    physgnn_speed._side[:] = [Variant(precision, plain, dataset, given)]


def compare(dataset: int, given: argparse.Namespace) -> None:
    context = get_context("spawn")
    with ExitStack() as stack:
        processes = [
            stack.enter_context(
                ProcessPoolExecutor(1, context, begin, (*row, dataset, given))
            )
            for row in ROWS
        ]

        def results(what: str) -> list[Any]:
            return [process.submit(ask, what).result() for process in processes]

        def seconds(what: str) -> list[float]:
            timings = [lambda p=p: p.submit(ask, what).result() for p in processes]
            return medians(timings, given.repeats)

        outputs, gradients = results("outputs"), results("gradients")
        forward, step = seconds("forward_seconds"), seconds("step_seconds")
    print(f"dataset {dataset}, training batch {CASES[dataset][1]}")
    for k, (precision, plain) in enumerate(ROWS):
        name = f"{precision}, {'torch.nn.LSTM' if plain else 'compiled'}"
        ours = k - k % 2
        print(
            f"  {name:<26}{forward[k]:9.3f} s {forward[k] / forward[ours]:5.2f}"
            f"{step[k]:12.3f} s {step[k] / step[ours]:5.2f}"
            f"{abs(outputs[k] - outputs[0]).max():11.1e} mm"
            f"{gradients_apart(gradients[0], gradients[k]):10.1e}",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    add_arguments(parser)
    given = parser.parse_args()
    heads = "forward, a sample", "step, a sample", "outputs", "gradients"
    print(f"{heads[0]:>44}{heads[1]:>21}{heads[2]:>14}{heads[3]:>11}", flush=True)
    for dataset in given.datasets:
        compare(dataset, given)


if __name__ == "__main__":
    main()

"""Whether torch.compile makes PhysGNN's forward pass or training step faster.

    python benchmarks/physgnn_compile.py ../shared/paper

Configuration 3 of dataset 2, published weights, one thread, seconds of its processor
time. The LSTMs, which are compiled already, and the sparse products are left alone;
torch.compile gets all between. It needs a C++ compiler.
"""

import argparse
import time
import warnings
from functools import partial
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.cpu import LayerScores
from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.layers import convolution
from physgnn.learning.physgnn.published import load_published
from physgnn.learning.training.objective.losses import mean_euclidean
from physgnn_speed import batch_of, medians, second_call

BATCH = 8


def leave_alone() -> None:
    """Keep torch.compile from what it cannot look into."""
    for owner, name in ((convolution, "aggregate"), (LayerScores, "__call__")):
        setattr(owner, name, torch.compiler.disable(getattr(owner, name)))


def measure(network: nn.Module, batch: Tensor, graph: Graph, repeats: int) -> None:
    def forward() -> None:
        with torch.inference_mode():
            network(batch[:1], graph)

    def step() -> None:
        mean_euclidean(
            network(batch, graph), torch.zeros(*batch.shape[:2], 3)
        ).backward()

    compiled = torch.compile(network, dynamic=True)

    def compiled_forward() -> None:
        with torch.inference_mode():
            compiled(batch[:1], graph)

    def compiled_step() -> None:
        truth = torch.zeros(*batch.shape[:2], 3)
        mean_euclidean(compiled(batch, graph), truth).backward()

    for what, functions, share in (
        ("forward, 1 sample", (forward, compiled_forward), 1),
        (f"training step, batch {BATCH}, a sample", (step, compiled_step), BATCH),
    ):
        start = time.process_time()
        for function in functions:
            function()
            function()
        first = time.process_time() - start
        timings = [partial(second_call, f, time.process_time) for f in functions]
        plain, fused = medians(timings, repeats)
        print(
            f"{what}: {plain / share:.3f} s, compiled {fused / share:.3f} s "
            f"(first calls {first:.0f} s)"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    torch.set_num_threads(1)
    golden = np.load(options.folder / "golden_forward.npz")
    mesh = TetMesh(golden["points"], golden["cells"], golden["region"])
    weights = options.folder / "config3_dataset2.pt"
    network = load_published(weights, configuration=3, dataset=2)
    leave_alone()
    batch = batch_of(torch.from_numpy(golden["x_2"]), BATCH)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        measure(network, batch, Graph.from_mesh(mesh), options.repeats)


if __name__ == "__main__":
    main()

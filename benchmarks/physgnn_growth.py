"""How PhysGNN's time and memory grow with the mesh: one body, finer and finer.

    python benchmarks/physgnn_growth.py --sizes 10000 30000 100000

Configuration 3 of dataset 2, with a load on every point, so that nothing is pruned,
and on the 100 points nearest to one. One thread, in seconds of its processor time, so
that other work on the machine counts little. Memory is what a backward pass keeps of
the forward pass of one sample. Prints a Markdown table and the exponents of growth.
"""

import argparse
import time
from collections.abc import Callable, Sequence

import numpy as np
import torch
from torch import Tensor

from fe_growth import brain
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.network import PhysGNN
from physgnn.learning.training.samples.memory import MEGABYTE, kept_bytes
from tables import machine, table

N_LOADED = 100
COLUMNS = (
    "points",
    "forward, all loaded, s",
    f"forward, {N_LOADED} loaded, s",
    "training, all loaded, MB",
)


def features(mesh: TetMesh, n_loaded: int) -> Tensor:
    """Return features with a random load on the points nearest to the topmost one."""
    top = mesh.points[mesh.points[:, 2].argmax()]
    loaded = np.linalg.norm(mesh.points - top, axis=1).argsort()[:n_loaded]
    x = torch.zeros(mesh.n_points, 7)
    x[loaded, 1:] = torch.randn(n_loaded, 6, generator=torch.manual_seed(0))
    return x


def seconds(function: Callable[[], object], repeats: int = 3) -> float:
    """Return the least processor time of some calls, after one that isn't counted."""
    function()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return min(times)


def row_of(mesh: TetMesh) -> list[float]:
    network, graph = PhysGNN().eval(), Graph.from_mesh(mesh)
    times = []
    for n_loaded in (mesh.n_points, N_LOADED):
        x = features(mesh, n_loaded)
        with torch.inference_mode():
            times.append(seconds(lambda x=x: network(x, graph)))
    x = features(mesh, mesh.n_points)
    return [mesh.n_points, *times, kept_bytes(lambda: network(x, graph)) / MEGABYTE]


def growth(sizes: Sequence[int]) -> None:
    rows = np.array([row_of(brain(size)) for size in sizes])
    table(COLUMNS, [[f"{value:.4g}" for value in row] for row in rows])
    for name, values in zip(COLUMNS[1:], rows.T[1:], strict=True):
        exponent = np.polyfit(np.log(rows[:, 0]), np.log(values), 1)[0]
        print(f"\n{name} ~ points^{exponent:.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    sizes = [10_000, 30_000, 100_000]
    parser.add_argument("--sizes", type=int, nargs="+", default=sizes)
    options = parser.parse_args()
    torch.set_num_threads(1)
    print(machine() + "\n")
    growth(options.sizes)


if __name__ == "__main__":
    main()

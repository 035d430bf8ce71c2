"""The published weights as ONNX: is onnxruntime's output ours, and how long it takes.

    python benchmarks/physgnn_onnx.py ../shared/paper --threads 2 --repeats 5

The folder holds the published weights and ``golden_forward.npz``. Prints how far the
outputs are apart, medians, and the size of the file.
"""

import argparse
import tempfile
from functools import partial
from pathlib import Path

import numpy as np
import onnxruntime
import torch

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.published import load_published
from physgnn.learning.runs.onnx import write_onnx
from physgnn_speed import CASES, medians, second_call


def session_of(file: Path, threads: int) -> onnxruntime.InferenceSession:
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    return onnxruntime.InferenceSession(file, options)


def compare(
    folder: Path, configuration: int, dataset: int, options: argparse.Namespace
) -> None:
    golden = np.load(folder / "golden_forward.npz")
    mesh = TetMesh(golden["points"], golden["cells"], golden["region"])
    graph, x = Graph.from_mesh(mesh), golden[f"x_{dataset}"]
    weights = folder / f"config{configuration}_dataset{dataset}.pt"
    network = load_published(weights, configuration, dataset)
    with tempfile.TemporaryDirectory() as scratch, torch.inference_mode():
        file = Path(scratch) / "physgnn.onnx"
        write_onnx(network, graph, file)
        session = session_of(file, options.threads)
        size = file.stat().st_size / 1e6
        features = torch.from_numpy(x)
        theirs = session.run(None, {"features": x})[0]
        apart = abs(theirs - network(features, graph).numpy()).max()
        calls = (
            lambda: session.run(None, {"features": x}),
            lambda: network(features, graph),
        )
        timings = [partial(second_call, call) for call in calls]
        seconds = medians(timings, options.repeats)
    print(
        f"configuration {configuration}, dataset {dataset}: {apart:.1e} mm apart; "
        f"onnxruntime {seconds[0]:.3f} s, ours {seconds[1]:.3f} s; {size:.1f} MB"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    for dataset, (configuration, _) in CASES.items():
        compare(options.folder, configuration, dataset, options)


if __name__ == "__main__":
    main()

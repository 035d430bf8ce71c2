"""What a prediction of the lifted network takes, part by part, and a cold FE solve.

    python benchmarks/lifted.py run/ loads.zarr --threads 2

The load cases are of the last paths at low, middle and full load. Each is asked for
twice in a row: the first time its anchor's factor has to come from memory, since other
anchors were used in between; the second, as when a force is dragged about, what of it
the processor's cache holds is there already. Every time is the median of ``--repeats``
rounds over the cases, after one that isn't counted.
"""

import argparse
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import torch

from physgnn.choices import Estimate
from physgnn.dataset import Store
from physgnn.learning.graph import graph_of
from physgnn.learning.lifted.model import LiftedModel
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction import FiniteElementPredictor, Predictor
from tables import load_kernels, machine, table

LIMIT_MS = 20.0


def median_ms(
    do: Callable[[LoadCase], object], cases: Sequence[LoadCase], n: int
) -> tuple[float, float]:
    """Return the time of another case every time, and of the same case again."""
    times = np.empty((2, n, len(cases)))
    for i in range(n):
        for k, case in enumerate(cases):
            for again in (0, 1):
                start = time.perf_counter()
                do(case)
                times[again, i, k] = time.perf_counter() - start
    other, same = 1e3 * np.median(times[:, 1:], axis=(1, 2))
    return float(other), float(same)


def parts(model: LiftedModel) -> dict[str, Callable[[LoadCase], object]]:
    n, graph = model.body.mesh.n_points, graph_of(model.body)
    terms = model.expansion

    def first(case: LoadCase) -> object:
        force = case.on_points(n)
        return terms.about(force).first(force)

    def until_curvature(case: LoadCase) -> object:
        force = case.on_points(n)
        about = terms.about(force)
        return about.curvature(about.first(force))

    @torch.inference_mode()
    def unrefined(case: LoadCase) -> object:
        return model(model.encode(case).unsqueeze(0), graph)

    return {
        "u₁": first,
        "u₁, second variation": until_curvature,
        "u₁, second variation, u₂": lambda case: terms.expand(case.on_points(n)),
        "the same as the network's inputs": model.encode,
        "network and response modes": unrefined,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path)
    parser.add_argument("store", type=Path)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=15)
    given = parser.parse_args()
    torch.set_num_threads(given.threads)
    store = Store.open(given.store)
    last, top = store.n_paths - 1, store.n_levels - 1
    cases = [
        store.load_case(last - i, level)
        for i in range(3)
        for level in (top // 6, top // 2, top)
    ]
    print(f"{machine()}; {given.threads} threads; {store.mesh.n_points} points\n")
    load_kernels()
    start = time.perf_counter()
    predictor = Predictor.load(given.run)
    loaded = time.perf_counter() - start
    model = Checkpoint.load(given.run).model.eval()
    assert isinstance(model, LiftedModel)
    steps = {
        **parts(model),
        "displacement: with the worst patches relaxed": predictor.surrogate.predict,
        "prediction: with quick error bound and trained range": partial(
            predictor, estimate=Estimate.QUICK
        ),
    }
    times = {name: median_ms(do, cases, given.repeats) for name, do in steps.items()}
    table(
        ("up to", "another anchor before it, ms", "the same again, ms"),
        [(name, f"{a:.1f}", f"{b:.1f}") for name, (a, b) in times.items()],
    )
    print(f"\nat most {LIMIT_MS:g} ms wanted; {loaded:.1f} s to load the run")
    cold = FiniteElementPredictor(predictor.body)
    seconds = [cold(case).seconds for case in cases]
    print(f"finite elements from rest: {np.median(seconds):.2f} s (median of the same)")


if __name__ == "__main__":
    main()

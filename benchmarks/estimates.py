"""What the two error estimates cost, on the bundled model and new loads.

    OMP_NUM_THREADS=2 python benchmarks/estimates.py
    OMP_NUM_THREADS=1 python benchmarks/estimates.py

Loads of the demonstration's kind, drawn anew, at all levels. The two estimates take
turns, so that other work on the machine is in both. Times are by the wall clock and of
the processor, all threads together.
"""

import argparse
import os
import time

import numpy as np

from physgnn.bundled import BUNDLED_RUN
from physgnn.choices import Estimate
from physgnn.dataset import PRESETS
from physgnn.mechanics import LoadCase
from physgnn.prediction.predictor import Predictor
from tables import machine, table


def drawn_cases(predictor: Predictor, count: int) -> list[LoadCase]:
    """Return loads that the model was trained for, spread over paths and levels."""
    assert predictor.calibration is not None
    loaded = np.array(predictor.calibration.trained_range.nodes, dtype=np.int64)
    paths = PRESETS["demo"].paths(predictor.body.mesh, loaded)
    return [paths[i % len(paths)].case(i % paths[0].n_levels) for i in range(count)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=40)
    given = parser.parse_args()
    predictor = Predictor.load(BUNDLED_RUN)
    cases = drawn_cases(predictor, given.cases)
    for estimate in Estimate:
        predictor(cases[0], estimate=estimate)  # compiles and factorises
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in Estimate}
    for case in cases:
        for name in Estimate:
            begun = time.process_time()
            seconds = predictor(case, estimate=name).seconds
            times[name].append((seconds, time.process_time() - begun))
    threads = os.environ.get("OMP_NUM_THREADS", "all")
    print(f"{machine()}; {threads} threads; {predictor.body.mesh.n_points} points")
    table(
        ("estimate", "50 %, ms", "95 %, ms", "of the processor: 50 %", "95 %"),
        [
            (
                name,
                *(f"{1e3 * q:.0f}" for q in np.quantile(t, [0.5, 0.95], axis=0).T.flat),
            )
            for name, t in times.items()
        ],
    )


if __name__ == "__main__":
    main()

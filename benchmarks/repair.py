"""Predictions taken to a tolerance, beside cold solves and other starts, held out.

    python benchmarks/repair.py runs/lifted loads.zarr --log repair.jsonl --seconds 220

Times are wall-clock with all cores: run it on a quiet machine. What the log has is not
measured again, so it may be made in parts of ``--seconds`` each. Prints Markdown.
"""

import argparse
import time
from pathlib import Path

import numpy as np
import torch

from held_out import Log, Sample, lengths, spread
from physgnn.dataset import Store, named_split
from physgnn.learning.baselines.linear import Linear
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.surrogate import FromFunction, Surrogate
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.finite_element import FiniteElementPredictor
from physgnn.prediction.prediction import Predict, Prediction
from physgnn.prediction.predictor import Predictor
from tables import machine, table

GROUPS = ((1, 5), (6, 10), (11, 15), (16, 20), (21, 25), (26, 30), (1, 30))


class Other(FromFunction):
    """Another start, with the same reference states to repair it from."""

    def __init__(self, model: Surrogate, displacement) -> None:
        super().__init__(model.body, displacement)
        self.reference_states = model.reference_states


class Starts:
    """What is compared: each brings a sample within the tolerance."""

    def __init__(self, run: Path, store: Store, tolerance_mm: float) -> None:
        self.store, self._tolerance_mm = store, tolerance_mm
        model = Checkpoint.load(run).model
        body = model.body
        self._before = np.zeros((body.mesh.n_points, 3))
        self.predict: dict[str, Predict] = {
            "network": Predictor.load(run),
            "cold solve": FiniteElementPredictor(body, threads=torch.get_num_threads()),
            "linear solution": Predictor(Other(model, Linear(body).predict)),
            "zero": Predictor(Other(model, self._zero)),
            "frame before": Predictor(Other(model, lambda _: self._before)),
        }
        for name in self.predict:  # compiles, allocates, analyses the pattern
            self(name, (0, 0))

    def _zero(self, _: LoadCase) -> np.ndarray:
        return np.zeros_like(self._before)

    def __call__(self, what: str, sample: Sample) -> Prediction:
        """Repair a sample from one of the starts."""
        path, level = sample
        self._before = self._zero(self.store.load_case(path, level))
        if level:
            self._before += self.store.displacement(path)[level - 1]
        case = self.store.load_case(path, level)
        return self.predict[what](case, tolerance_mm=self._tolerance_mm)


def measure(starts: Starts, names, samples, log: Log, end: float) -> None:
    """Log what is missing of some starts, sample by sample, until the time is up."""
    missing = {name: set(log.missing(samples, name)) for name in names}
    for sample in samples:
        for name in names:
            if time.perf_counter() > end:
                return
            if sample in missing[name]:
                measure_one(starts, name, sample, log)


def measure_one(starts: Starts, name: str, sample: Sample, log: Log) -> None:
    path, level = sample
    begun = time.process_time()
    found = starts(name, sample)
    processor = time.process_time() - begun
    truth = starts.store.displacement(path)[level]
    log.add(
        path=path,
        level=level + 1,
        what=name,
        error=lengths(truth - found.displacement)[1],
        seconds=found.seconds,
        processor_seconds=processor,
        status=found.status.name,
    )


def report(log: Log, tolerance_mm: float) -> None:
    for name in dict.fromkeys(record["what"] for record in log.records):
        print(f"\n### {name}\n")
        head = (
            "levels",
            "samples",
            f"error ≤ {tolerance_mm:g} mm",
            "largest error, mm",
        )
        rows = []
        for first, last in GROUPS:
            group = [r for r in log.of(name) if first <= r["level"] <= last]
            if not group:
                continue
            error = np.array([r["error"] for r in group])
            processor = [r.get("processor_seconds", np.nan) for r in group]
            rows.append(
                (
                    f"{first} to {last}",
                    len(group),
                    f"{100 * np.mean(error <= tolerance_mm):.1f} %",
                    f"{error.max():.4f}",
                    quantiles([r["seconds"] for r in group]),
                    quantiles(processor),
                    statuses(group),
                )
            )
        table((*head, "seconds, 50 / 95 / 100 %", "of processor", "status"), rows)


def quantiles(values) -> str:
    return " / ".join(f"{v:.2f}" for v in np.quantile(values, (0.5, 0.95, 1.0)))


def statuses(records) -> str:
    names, counts = np.unique([r["status"] for r in records], return_counts=True)
    return ", ".join(
        f"{n} {name.lower()}" for name, n in zip(names, counts, strict=True)
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run", type=Path)
    parser.add_argument("store", type=Path)
    parser.add_argument(
        "-o", "--out", "--log", dest="log", type=Path, default=Path("repair.jsonl")
    )
    parser.add_argument("--per-level", type=int, default=7)
    parser.add_argument("--others-per-level", type=int, default=2)
    parser.add_argument("--tolerance-mm", type=float, default=0.1)
    parser.add_argument("--split", default="path")
    parser.add_argument("--seconds", type=float, default=np.inf)
    options = parser.parse_args()
    print(machine())
    store = Store.open(options.store)
    test = named_split(options.split, store).test
    log = Log(options.log)
    many = spread(test, options.per_level)
    few = spread(test, options.others_per_level)
    end = time.perf_counter() + options.seconds
    if options.seconds > 0:
        starts = Starts(options.run, store, options.tolerance_mm)
        for names, samples in ((list(starts.predict), few), (["network"], many)):
            measure(starts, names, samples, log, end)
    report(log, options.tolerance_mm)


if __name__ == "__main__":
    main()

"""What somebody waits for: help, a mistake, a prediction and a registration.

    python benchmarks/waiting.py --threads 2 --json waiting.json

Commands are timed from their start to their end, files written, beside the least that
any program in Python takes and the least that one with PyTorch takes; predictions in
process, with their error bound, beside the linear solution; registrations, the first
and the next one of a series. Within a table all take turns in each round, so that other
work on the machine is in all alike. A first round is not counted: it compiles and fills
the system's file cache.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import torch

from physgnn.arrays import FloatArray
from physgnn.bundled import BUNDLED_RUN
from physgnn.choices import Estimate
from physgnn.io import read_load_path
from physgnn.io.medical.markups import read_point_pairs
from physgnn.learning.models import build_model
from physgnn.learning.runs.folder import RunFolder
from physgnn.mechanics import LoadCase
from physgnn.prediction import Predictor
from physgnn.stages.patient.intraoperative.patient_body import ready_registrar
from tables import machine, table

Times = dict[str, list[tuple[float, float]]]  # seconds, and those of the processor

DONE, WRONG_INPUT, NOT_USABLE = 0, 2, 3  # exit codes of `physgnn`
FURTHER = 1.2  # how much farther than measured the next state has moved
LOAD = {"points": [[39.7, 8.8, 62.5]], "forces_n": [[0.0, 0.0, -0.2]]}
MEASURED = Path(__file__).parents[1] / "examples" / "measured.csv"


def commands(folder: Path) -> dict[str, list[str]]:
    """Return what is run, by what it is called."""
    load = folder / "load.json"
    load.write_text(json.dumps(LOAD))
    physgnn = [sys.executable, "-m", "physgnn"]
    predict = [*physgnn, "predict", "--load", str(load), "-o"]
    case = str(RunFolder(BUNDLED_RUN).case)
    register = [*physgnn, "register", case, "--points", str(MEASURED), "-o"]
    return {
        "`python -c pass`": [sys.executable, "-c", "pass"],
        "`python -c 'import torch'`": [sys.executable, "-c", "import torch"],
        "`physgnn --help`": [*physgnn, "--help"],
        "`physgnn predict --help`": [*physgnn, "predict", "--help"],
        "`physgnn register --help`": [*physgnn, "register", "--help"],
        "wrong suffix": [*predict, str(folder / "displacement.xyz")],
        "`physgnn predict`": [*predict, str(folder / "displacement.vtu")],
        "`physgnn register`": [*register, str(folder / "shift.vtu")],
    }


def run(command: list[str], threads: int) -> tuple[float, float]:
    """Return the seconds of a command, by the clock and of the processor."""
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    spent, begun = _processor_seconds(), time.perf_counter()
    ended = subprocess.run(
        command, env=environment, capture_output=True, text=True, check=False
    )
    seconds = time.perf_counter() - begun
    if ended.returncode not in (DONE, WRONG_INPUT, NOT_USABLE):
        sys.exit(f"{' '.join(command)} failed: {ended.stderr}")
    return seconds, _processor_seconds() - spent


def _processor_seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def predictions(folder: Path) -> dict[str, Callable[[], object]]:
    """Return predictions in process, and the linear solution."""
    predictor = Predictor.load(BUNDLED_RUN)
    body = predictor.body
    one = read_load_path(folder / "load.json", body.mesh).case(0)
    patch = _patch(predictor, one)
    linear = build_model("linear", body)
    found: dict[str, Callable[[], object]] = {}
    for where, case in (("one point", one), ("a patch", patch)):
        for estimate in Estimate:
            name = f"prediction, {estimate} estimate, load on {where}"
            found[name] = partial(predictor, case, estimate=estimate)
        found[f"linear solution, load on {where}"] = partial(linear.predict, case)
    return found


class Operation:
    """Two states of a brain, registered one after the other."""

    def __init__(self, case: Path) -> None:
        self._register = ready_registrar(case)
        self.first = read_point_pairs(MEASURED)
        moved = FURTHER * (self.first.target - self.first.source)
        self._next = replace(self.first, target=self.first.source + moved)
        self._reached: FloatArray | None = None

    def register_first(self) -> None:
        """Register the first state by itself."""
        self._reached = self._register(self.first).prediction.displacement

    def register_next(self) -> None:
        """Register the next state from where the first one ended."""
        self._register(self._next, after=self._reached)


def registrations(case: Path) -> dict[str, Callable[[], object]]:
    """Return what a registration takes in process: once a patient, first, and next."""
    operation = Operation(case)
    return {
        "load modes and factor, once a patient": partial(ready_registrar, case),
        f"registration of {len(operation.first.source)} pairs": (
            operation.register_first
        ),
        "the next state of a series": operation.register_next,
    }


def _patch(predictor: Predictor, one: LoadCase) -> LoadCase:
    """Return the same force on all points that the model's loads act on."""
    assert predictor.calibration is not None
    nodes = np.array(predictor.calibration.trained_range.nodes, dtype=np.int64)
    return LoadCase(
        nodes, np.tile(one.forces.sum(axis=0) / len(nodes), (len(nodes), 1))
    )


def timed(do: Callable[[], object]) -> tuple[float, float]:
    """Return the seconds of a call, by the clock and of the processor."""
    spent, begun = time.process_time(), time.perf_counter()
    do()
    return time.perf_counter() - begun, time.process_time() - spent


def rounds(
    does: Mapping[str, Callable[[], tuple[float, float]]], repeats: int
) -> Times:
    """Return the times of all, which take turns; the first round is not counted."""
    times: Times = {name: [] for name in does}
    for count in range(repeats + 1):
        for name, do in does.items():
            spent = do()
            if count:
                times[name].append(spent)
    return times


def rows(times: Times, unit: float, digits: int) -> Iterable[tuple[str, ...]]:
    """Yield a row for each: medians and the least, by the clock and processor."""
    for name, spent in times.items():
        middle, least = np.median(spent, axis=0), np.min(spent, axis=0)
        figures = np.column_stack([middle, least]).ravel() * unit
        yield name, *(f"{figure:.{digits}f}" for figure in figures)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=Path, help="where all times go")
    given = parser.parse_args()
    torch.set_num_threads(given.threads)
    print(f"{machine()}; {given.threads} threads, {given.repeats} rounds\n")
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        started = {
            name: partial(run, command, given.threads)
            for name, command in commands(folder).items()
        }
        waited = rounds(started, given.repeats)
        within = {n: partial(timed, do) for n, do in predictions(folder).items()}
        warm = rounds(within, 4 * given.repeats)
    case = RunFolder(BUNDLED_RUN).case
    registering = {n: partial(timed, do) for n, do in registrations(case).items()}
    registered = rounds(registering, given.repeats)
    head = ("median", "least", "of the processor: median", "least")
    table(("command, s", *head), rows(waited, 1.0, 2))
    print()
    table(("in process, ms", *head), rows(warm, 1e3, 1))
    print()
    table(("in process, s", *head), rows(registered, 1.0, 2))
    if given.json is not None:
        kept = {
            "machine": machine(),
            "threads": given.threads,
            "seconds": waited | warm | registered,
        }
        given.json.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

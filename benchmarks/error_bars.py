"""How near estimates and indicators come to the true error, on held-out load paths.

    python benchmarks/error_bars.py runs/lifted loads.zarr --log error-bars.jsonl
    python benchmarks/error_bars.py runs/lifted loads.zarr --untrained …

Prints Markdown tables. What the log has is not measured again: stop it when you like.
``--untrained`` judges the lifted network's expansion alone.
"""

import argparse
import time
from pathlib import Path

import numpy as np

from held_out import Log, lengths, spread
from physgnn.dataset import Store, named_split
from physgnn.learning.lifted.model import LiftedModel
from physgnn.learning.lifted.own_axes import body_axes
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.surrogate import FromFunction
from physgnn.mechanics.elements.cell_kinematics import deformation_gradient
from physgnn.prediction.error_bounds.calibration import FLOOR_MM, Calibration
from physgnn.prediction.error_bounds.indicators import INDICATORS
from physgnn.prediction.predictor import Predictor
from tables import machine, table

GROUPS = ((1, 5), (6, 10), (11, 15), (16, 20), (21, 25), (26, 30))
CHEAP = ("correction", "residual")


def expansion(run: Path) -> FromFunction:
    """Return the lifted network as it is before anything is learnt."""
    model = Checkpoint.load(run).model
    assert isinstance(model, LiftedModel)
    axes = body_axes(model.body.mesh)
    alone = FromFunction(
        model.body,
        lambda case: model.encode(case)[:, :3].numpy().astype(np.float64) @ axes,
    )
    alone.linear = model.linear  # type: ignore[method-assign]
    alone.reference_states = model.reference_states  # type: ignore[method-assign]
    return alone


def measure(predictor: Predictor, store: Store, samples, log: Log, end: float) -> None:
    """Log sizes of the true error and of every estimate, until the time is up."""
    cheap = {name: INDICATORS[name](predictor.surrogate) for name in CHEAP}
    for path, level in samples:
        if time.perf_counter() > end:
            return
        case = store.load_case(path, level)
        predicted = predictor.surrogate.predict(case)
        start = time.perf_counter()
        estimate = predictor.error(case, predicted)
        seconds = time.perf_counter() - start
        relaxed = predictor.relax(case, predicted)
        truth = store.displacement(path)[level]
        record = {"path": path, "level": level + 1, "what": "error"}
        for name, found in cheap.items():
            record[name] = lengths(found(case, predicted))
        log.add(
            **record,
            true=lengths(truth - predicted),
            relaxation=lengths(estimate),
            seconds=seconds,
            inverted=inverted(store, predicted),
            inverted_after=inverted(store, relaxed.displacement),
        )


def inverted(store: Store, displacement: np.ndarray) -> int:
    volumes = np.linalg.det(deformation_gradient(store.mesh, displacement))
    return int((volumes <= 0).sum())


def report_bounds(records, calibrations: dict[str, Calibration]) -> None:
    """Print how often each bound held, and how far above the error it was."""
    print("\nbounds, of the mean | of the largest\n")
    head = ("coverage", "held", "up to level 15", "beyond", "median bound / error")
    rows = []
    for name, calibration in calibrations.items():
        promises = (calibration.coverage, *(row[0] for row in calibration.others))
        for coverage in promises:
            at = calibration.at(coverage)
            factors = np.array([at.mean_factor, at.max_factor])
            sizes = np.array([r[name] for r in records]) + FLOOR_MM
            true = np.array([r["true"] for r in records])
            held = 100.0 * (true <= factors * sizes)
            low = np.array([r["level"] <= 15 for r in records])
            parts = (held, held[low], held[~low])
            shares = [both(part.mean(axis=0), "{:.1f} %") for part in parts]
            over = both(np.median(factors * sizes / true, axis=0), "{:.1f}")
            rows.append((f"{100 * coverage:.0f} %, {name}", *shares, over))
    table(head, rows)


def ratios(records, name: str) -> np.ndarray:
    """Return estimate over true error, (n, 2): mean and largest."""
    return np.array([np.divide(r[name], r["true"]) for r in records])


def report(records) -> None:
    print("\nestimate over true error, of the mean | of the largest\n")
    head = ("levels", "samples", "within a factor of 2", "too small by more")
    rows = []
    for first, last in (*GROUPS, (1, 15), (16, 30)):
        group = [r for r in records if first <= r["level"] <= last]
        q = ratios(group, "relaxation")
        near = (q > 0.5) & (q < 2.0)
        rows.append(
            (
                f"{first} to {last}",
                len(group),
                both(100 * near.mean(axis=0), "{:.1f} %"),
                both(100 * (q <= 0.5).mean(axis=0), "{:.1f} %"),
                *quantiles(q),
            )
        )
    table((*head, "2.5 / 50 / 97.5 %, mean", "largest"), rows)
    print("\nlargest indicator over largest error, 2.5 / 50 / 97.5 %\n")
    rows = []
    for first, last in GROUPS:
        group = [r for r in records if first <= r["level"] <= last]
        names = (*CHEAP, "relaxation")
        rows.append(
            (f"{first} to {last}", *(quantiles(ratios(group, n))[1] for n in names))
        )
    table(("levels", *CHEAP, "relaxation"), rows)
    print("\ninverted cells\n")
    table(
        ("levels", "predictions with any", "most in one", "any after relaxation"),
        (
            (
                f"{first} to {last}",
                sum(r["inverted"] > 0 for r in group),
                max(r["inverted"] for r in group),
                sum(r["inverted_after"] > 0 for r in group),
            )
            for first, last in GROUPS
            for group in [[r for r in records if first <= r["level"] <= last]]
        ),
    )
    seconds = np.quantile([r["seconds"] for r in records], (0.5, 0.95))
    print(f"\nan estimate: {seconds[0]:.3f} s, 95th percentile {seconds[1]:.3f} s")


def both(pair: np.ndarray, form: str) -> str:
    return " | ".join(form.format(value) for value in pair).replace("|", "\\|")


def quantiles(q: np.ndarray) -> list[str]:
    """Return three quantiles of each column as text."""
    return [
        " / ".join(f"{v:.2g}" for v in np.quantile(column, (0.025, 0.5, 0.975)))
        for column in q.T
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run", type=Path)
    parser.add_argument("store", type=Path)
    parser.add_argument(
        "-o", "--out", "--log", dest="log", type=Path, default=Path("error-bars.jsonl")
    )
    parser.add_argument("--per-level", type=int, default=16)
    parser.add_argument("--seconds", type=float, default=np.inf)
    parser.add_argument("--untrained", action="store_true")
    parser.add_argument("--part", choices=("test", "validation"), default="test")
    options = parser.parse_args()
    print(machine())
    store = Store.open(options.store)
    samples = getattr(named_split("path", store), options.part)
    log = Log(options.log)
    missing = list(log.missing(spread(samples, options.per_level), "error"))
    end = time.perf_counter() + options.seconds
    if missing and options.seconds > 0:
        predictor = Predictor.load(options.run)
        if options.untrained:
            predictor = Predictor(expansion(options.run))
        measure(predictor, store, missing, log, end)
    report(log.of("error"))
    files = RunFolder(options.run).calibrations
    made = [Calibration.read(file) for file in files if file.is_file()]
    report_bounds(log.of("error"), {each.indicator: each for each in made})


if __name__ == "__main__":
    main()

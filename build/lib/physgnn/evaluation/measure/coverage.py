"""How far error estimates and bounds can be trusted: each beside the true error."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.evaluation.measure.held_out import HeldOut
from physgnn.io.integrity.atomic import write_whole
from physgnn.prediction.error_bounds.calibration import Calibration
from physgnn.prediction.predictor import Predictor
from physgnn.progress import Progress

MAX_SAMPLES = 240  # the physical estimate takes ten times as long as a prediction
FACTOR = 2.0  # the estimate is to be right within


@dataclass(frozen=True)
class Bound:
    """One bound on one sample's error.

    Attributes
    ----------
    indicator : str
        What it rests on.
    promised : float
        Its coverage.
    mean, largest : float
        On the mean and on the largest nodal error, mm.
    """

    indicator: str
    promised: float
    mean: float
    largest: float


@dataclass(frozen=True)
class BarSample:
    """True errors of one sample, mm, and all that was said of them beforehand."""

    path: int
    level: int
    load_factor: float
    mean: float
    largest: float
    likely_mean: float
    likely_largest: float
    bounds: tuple[Bound, ...]


def measure_bars(
    predictor: Predictor, held_out: HeldOut, *, progress: Progress | None = None
) -> tuple[BarSample, ...]:
    """Return true errors, estimates and bounds of test samples.

    Parameters
    ----------
    predictor : Predictor
        Its calibrations, if it has any, give the bounds.
    held_out : HeldOut
        If it has more than `MAX_SAMPLES`, as many are drawn from all of them.
    progress : callable, optional
        Called with (done, total, text) after every sample.
    """
    order = np.random.default_rng(0).permutation(len(held_out.test))[:MAX_SAMPLES]
    picked = held_out.test[np.sort(order)].tolist()
    made = []
    for done, (path, level) in enumerate(picked):
        made.append(_measured(predictor, held_out, path, level))
        if progress is not None:
            progress(done + 1, len(picked), "error bars")
    return tuple(made)


def _measured(
    predictor: Predictor, held_out: HeldOut, path: int, level: int
) -> BarSample:
    store = held_out.store
    case = store.load_case(path, level)
    displacement = predictor.surrogate.predict(case)
    error = np.linalg.norm(store.displacement(path)[level] - displacement, axis=1)
    field = predictor.error(case, displacement)
    likely = np.linalg.norm(field, axis=1)
    fields = (
        (predictor.calibration, predictor.indicate),
        (predictor.relaxation, lambda *_: field),
    )
    return BarSample(
        path=path,
        level=level,
        load_factor=float(store.load_factors[level]),
        mean=float(error.mean()),
        largest=float(error.max()),
        likely_mean=float(likely.mean()),
        likely_largest=float(likely.max()),
        bounds=tuple(
            bound
            for calibration, indicate in fields
            if calibration is not None
            for bound in _bounds(calibration, indicate(case, displacement))
        ),
    )


def _bounds(calibration: Calibration, field: FloatArray) -> list[Bound]:
    promises = (calibration.coverage, *(other[0] for other in calibration.others))
    bounds = ((c, calibration.at(c).estimate(field)) for c in dict.fromkeys(promises))
    return [
        Bound(calibration.indicator, c, bound.mean_mm, bound.max_mm)
        for c, bound in bounds
    ]


def bar_facts(samples: Sequence[BarSample]) -> dict[str, Any]:
    """Return in words how near the estimate came and how often each bound held."""
    facts = {}
    for name, low, high in (("half the load", 0.0, 0.5), ("all of it", 0.5, 1.0)):
        some = [s for s in samples if low < s.load_factor <= high + 1e-9]
        if some:
            facts[f"physical estimate, up to {name}"] = _nearness(some)
    for indicator, promised in bound_kinds(samples):
        pairs = bound_pairs(samples, indicator, promised)
        held = 100 * (pairs[:, 0] <= pairs[:, 1]).mean(axis=0)
        size = np.median(pairs[:, 1] / pairs[:, 0], axis=0)
        facts[f"bound at {promised:.0%}, by {indicator}"] = (
            f"mean error held in {held[0]:.1f} %, largest in {held[1]:.1f} % of "
            f"{len(samples)} samples; median bound over error {size[0]:.2g} and "
            f"{size[1]:.2g}"
        )
    return facts


def _nearness(samples: Sequence[BarSample]) -> str:
    q = np.array(
        [(s.likely_mean / s.mean, s.likely_largest / s.largest) for s in samples]
    )
    near = 100 * ((q > 1 / FACTOR) & (q < FACTOR)).mean(axis=0)
    low = 100 * (q <= 1 / FACTOR).mean(axis=0)
    return (
        f"within a factor of {FACTOR:g} for the mean error in {near[0]:.1f} %, for the "
        f"largest in {near[1]:.1f} % of {len(samples)} samples; too small by more in "
        f"{low[0]:.1f} % and {low[1]:.1f} %"
    )


def bound_kinds(samples: Sequence[BarSample]) -> list[tuple[str, float]]:
    """Return the bounds there are, by indicator and promised coverage."""
    kinds = ((b.indicator, b.promised) for s in samples for b in s.bounds)
    return list(dict.fromkeys(kinds))


def bound_pairs(
    samples: Sequence[BarSample], indicator: str, promised: float
) -> FloatArray:
    """Return (n, 2, 2): true error and bound, of the mean and of the largest, mm."""
    return np.array(
        [
            [(s.mean, s.largest), (b.mean, b.largest)]
            for s in samples
            for b in s.bounds
            if (b.indicator, b.promised) == (indicator, promised)
        ]
    )


def write_bars(samples: Sequence[BarSample], file: Path) -> None:
    """Write every sample as JSON, whole or not at all."""
    record = [asdict(sample) for sample in samples]
    write_whole(file, json.dumps(record, indent=1, allow_nan=False))

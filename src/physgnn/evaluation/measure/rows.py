"""Rows of a comparison: predictors that are made when their turn comes."""

import hashlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.runs.checkpoint import check_mesh, read_record
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.record import processor_minutes
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.prediction import Predict
from physgnn.prediction.predictor import Predictor

REPAIRED = "certified"


@dataclass(frozen=True)
class Row:
    """One predictor to measure.

    Parameters
    ----------
    name : str
        Rows of one name differ in their seed alone and are shown as one.
    make : callable
        Returns the predictor; called once, so that no two need be in memory together.
    seed : int or None
        Of its training; None where nothing is drawn.
    minutes : float or None
        Of its training; None if making it is the training.
    tolerance_mm : float or None
        Asked of every prediction.
    origin : str
        What else the predictor's displacements depend on.
    case : callable
        From a store, path and level to what the predictor is told: by default the load.
    """

    name: str
    make: Callable[[], Predict]
    seed: int | None = None
    minutes: float | None = None
    tolerance_mm: float | None = None
    origin: str = ""
    case: Callable[[Store, int, int], LoadCase] = Store.load_case


def run_rows(
    runs: Sequence[Path], store: Store, precision: str = "float32"
) -> list[Row]:
    """Return one row a run; runs that differ in their seed alone share a name.

    The name is the model's, or, where two kinds of run are of one model, the name of
    the first run's folder without its seed.

    Parameters
    ----------
    runs : sequence of paths
        Folders.
    store : Store
        On whose mesh they shall predict.
    precision : str
        As in `Predictor.load`.

    Raises
    ------
    InputError
        If a folder is no finished run, two of a kind have the same seed, or runs of a
        kind were trained on different splits.
    """
    records = {run: read_record(run) for run in runs}
    kinds: dict[str, list[Path]] = {}
    for run, record in records.items():
        kind = _kind(record)
        kinds[kind] = [*kinds.pop(kind, []), run]  # the last run's kind comes last
    models = [records[of_kind[0]]["config"]["model"] for of_kind in kinds.values()]
    rows = []
    for of_kind, model in zip(kinds.values(), models, strict=True):
        _check_seeds(of_kind, [records[run] for run in of_kind])
        name = model if models.count(model) == 1 else _without_seed(of_kind[0])
        rows += [_run_row(run, records[run], name, store, precision) for run in of_kind]
    return rows


def load_predictor(run: Path, store: Store, precision: str = "float32") -> Predictor:
    """Return a run's predictor for a store's mesh; InputError if it knows another."""
    check_mesh(read_record(run), store.mesh, run)
    return Predictor.load(run, precision=precision)


def _run_row(
    run: Path, record: dict[str, Any], name: str, store: Store, precision: str
) -> Row:
    files = RunFolder(run)
    follows_from = (files.weights, files.calibration)
    contents = [file.read_bytes() for file in follows_from if file.is_file()]
    rough = [] if precision == "float32" else [precision.encode()]
    return Row(
        name,
        make=lambda: load_predictor(run, store, precision),
        seed=record["config"]["seed"],
        minutes=processor_minutes(record),
        origin=_digest([*contents, *rough]),
    )


def repaired_row(row: Row, tolerance_mm: float) -> Row:
    """Return a row's predictor, repaired to a tolerance."""
    return replace(row, name=REPAIRED, tolerance_mm=tolerance_mm)


def _kind(record: dict[str, Any]) -> str:
    config = {k: v for k, v in record["config"].items() if k != "seed"}
    return repr(sorted(config.items()))


def _check_seeds(runs: Sequence[Path], records: Sequence[dict[str, Any]]) -> None:
    seeds = [record["config"]["seed"] for record in records]
    if len(set(seeds)) < len(seeds):
        raise InputError(
            f"{', '.join(map(str, runs))} must differ in their seed (got {seeds}): "
            "name each run once"
        )
    if len({(r["split"]["hash"], r["data"]["hash"]) for r in records}) > 1:
        raise InputError(
            f"{', '.join(map(str, runs))} differ in their seed alone, but were trained "
            "on different data or splits: evaluate them apart"
        )


def _without_seed(run: Path) -> str:
    name = run.resolve().name
    return name.rstrip("0123456789").rstrip("-_") or name


def _digest(parts: Iterable[bytes]) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part)
    return digest.hexdigest()

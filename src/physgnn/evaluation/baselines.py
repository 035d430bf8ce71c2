"""Baselines that every model is shown beside, each a predictor like any other."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from physgnn.errors import InputError
from physgnn.evaluation.held_out import HeldOut
from physgnn.evaluation.level_interpolation import LevelInterpolation
from physgnn.evaluation.rows import Row
from physgnn.learning.models import build_model
from physgnn.prediction.classical import REGRESSORS, regressor_answer
from physgnn.prediction.linear import linear_answer
from physgnn.prediction.network import network_answer
from physgnn.prediction.prediction import Predict
from physgnn.prediction.predictor import Predictor

FEW = 30  # loaded points; about more the reduced model takes seconds a prediction


def _always(_: HeldOut) -> bool:
    return True


@dataclass(frozen=True)
class Baseline:
    """How to make a predictor to compare with.

    Attributes
    ----------
    make : callable
        From what is held out and a seed to the predictor.
    applies : callable
        Whether it can be made.
    is_meant : callable
        Whether it is meant for such loads: else it must be asked for by name.
    learns : bool
        Whether making it is training, whose time counts.
    draws : bool
        Whether it depends on the seed.
    """

    make: Callable[[HeldOut, int], Predict]
    applies: Callable[[HeldOut], bool] = _always
    is_meant: Callable[[HeldOut], bool] = _always
    learns: bool = False
    draws: bool = False


def _zero(held_out: HeldOut, _: int) -> Predict:
    body = held_out.store.body
    nothing = np.zeros_like(body.mesh.points)
    return Predictor(body, lambda _: nothing)


def _linear(held_out: HeldOut, _: int) -> Predict:
    body = held_out.store.body
    return Predictor(body, linear_answer(body))


def _interpolation(held_out: HeldOut, _: int) -> Predict:
    answer = LevelInterpolation(held_out.store, held_out.train)
    return Predictor(held_out.store.body, answer)


def _knows_paths(held_out: HeldOut) -> bool:
    return bool(np.isin(held_out.test[:, 0], held_out.train[:, 0]).all())


def _has_examples(held_out: HeldOut) -> bool:
    return len(held_out.train) > 0


def _loads_few_points(held_out: HeldOut) -> bool:
    paths = np.unique(held_out.test[:, 0]).tolist()
    widest = max(len(held_out.store.load_path(path).nodes) for path in paths)
    return widest <= FEW


def _regressor(name: str) -> Baseline:
    def make(held_out: HeldOut, seed: int) -> Predict:
        store = held_out.store
        answer = regressor_answer(name, store, held_out.train, seed)
        return Predictor(store.body, answer)

    return Baseline(make, _has_examples, learns=True, draws=True)


def _fitted(name: str, is_meant: Callable[[HeldOut], bool] = _always) -> Baseline:
    def make(held_out: HeldOut, _: int) -> Predict:
        model = build_model(name, held_out.store.body)
        model.fit(held_out.store, held_out.train)
        return Predictor(model.body, network_answer(model))

    return Baseline(make, _has_examples, is_meant, learns=True)


BASELINES: Mapping[str, Baseline] = {
    "zero": Baseline(_zero),
    "linear": Baseline(_linear),
    "level_interpolation": Baseline(_interpolation, _knows_paths),
    **{name: _regressor(name) for name in REGRESSORS},
    "galerkin": _fitted("galerkin"),
    "reduced": _fitted("reduced", _loads_few_points),
}
QUICK = ("zero", "linear", "level_interpolation")  # made in seconds


def named_baselines(text: str, held_out: HeldOut) -> tuple[str, ...]:
    """Return the names that ``quick``, ``all`` or a list with commas stand for.

    ``all`` are those that are meant for such loads.
    """
    meant = tuple(k for k, row in BASELINES.items() if row.is_meant(held_out))
    known = {"quick": QUICK, "all": meant}
    return known.get(text, tuple(name.strip() for name in text.split(",")))


def baseline_rows(
    names: Iterable[str], held_out: HeldOut, *, seeds: Sequence[int] = (0,)
) -> list[Row]:
    """Return a row for each baseline that applies, and each seed if it draws any.

    Raises
    ------
    InputError
        If there is no such baseline.
    """
    rows = []
    for name in names:
        if name not in BASELINES:
            raise InputError(
                f"no baseline '{name}' (there are: {', '.join(BASELINES)})"
            )
        if BASELINES[name].applies(held_out):
            drawn = seeds if BASELINES[name].draws else (None,)
            rows += [_row(name, held_out, seed) for seed in drawn]
    return rows


def _row(name: str, held_out: HeldOut, seed: int | None) -> Row:
    baseline = BASELINES[name]
    return Row(
        name,
        lambda: baseline.make(held_out, seed or 0),
        seed=seed,
        minutes=None if baseline.learns else 0.0,
    )

"""Baselines: methods that are fitted on the spot, to show every model beside."""

import hashlib
import inspect
import sys
from collections.abc import Iterable, Sequence
from functools import cache

from physgnn.errors import InputError
from physgnn.evaluation.measure.held_out import HeldOut
from physgnn.evaluation.measure.rows import Row
from physgnn.learning.models import (
    MODELS,
    build_model,
    is_model,
    method_name,
    model_class,
)
from physgnn.learning.network import Network
from physgnn.learning.surrogate import Surrogate
from physgnn.prediction.prediction import Predict
from physgnn.prediction.predictor import Predictor

QUICK = ("zero", "linear", "interpolation")  # made in seconds


@cache
def baseline_names() -> tuple[str, ...]:
    """Return the methods there are that are fitted in one go.

    Returns
    -------
    tuple of str
        Rows of `physgnn.learning.models.MODELS`.
    """
    return tuple(k for k in MODELS if not issubclass(model_class(k), Network))


def named_baselines(text: str, held_out: HeldOut) -> tuple[str, ...]:
    """Return the names that ``quick``, ``all`` or a list with commas stand for.

    ``all`` are those that are meant for such loads.
    """
    store, test = held_out.store, held_out.test
    if text == "all":
        names = baseline_names()
        return tuple(k for k in names if model_class(k).is_meant_for(store, test))
    if text == "quick":
        return QUICK
    named = (method_name(name.strip()) for name in text.split(","))
    return tuple(dict.fromkeys(named))  # one row each, however often they are named


def baseline_rows(
    names: Iterable[str], held_out: HeldOut, *, seeds: Sequence[int] = (0,)
) -> list[Row]:
    """Return a row for each baseline that applies, and each seed if it draws any.

    Parameters
    ----------
    names : iterable of str
        Of `baseline_names`, or ``module:Class`` of one's own.
    held_out : HeldOut
        What is tested on, and what may be learnt from.
    seeds : sequence of int
        Those that the runs beside have.

    Returns
    -------
    list of Row
        In the order of the names.

    Raises
    ------
    InputError
        If there is no such baseline.
    """
    rows = []
    for name in map(method_name, names):
        method = _baseline(name)
        if method.applies_to(held_out.store, held_out.train, held_out.test):
            drawn = seeds if method.draws else (None,)
            rows += [_row(name, method, held_out, seed) for seed in drawn]
    return rows


def _baseline(name: str) -> type[Surrogate]:
    if not is_model(name):
        raise InputError(
            f"no baseline '{name}' (there are: {', '.join(baseline_names())}; name one "
            "of your own as module:Class)"
        )
    method = model_class(name)
    if issubclass(method, Network):
        raise InputError(
            f"no baseline '{name}': it is trained step by step; train it, and name its "
            "run beside the others"
        )
    return method


def _row(
    name: str, method: type[Surrogate], held_out: HeldOut, seed: int | None
) -> Row:
    def make() -> Predict:
        surrogate = build_model(name, held_out.store.body)
        surrogate.fit(held_out.store, held_out.train, seed or 0)
        return Predictor(surrogate)

    return Row(
        name,
        make,
        seed=seed,
        minutes=None if method.learns else 0.0,
        origin="" if name in MODELS else _source_digest(method),
    )


def _source_digest(method: type[Surrogate]) -> str:
    """Return a digest of the file a class is in: changed, it is measured anew."""
    source = inspect.getsource(sys.modules[method.__module__])
    return hashlib.sha256(source.encode()).hexdigest()

"""The networks there are: one row each.

How a network plugs in is written in :mod:`physgnn.learning.interface`.
"""

import inspect
from collections.abc import Mapping
from typing import Any

from physgnn.errors import InputError
from physgnn.learning.galerkin import GalerkinModel
from physgnn.learning.interface import Model
from physgnn.learning.lifted import LiftedModel
from physgnn.learning.physgnn_model import PhysGNNModel
from physgnn.learning.reduced import ReducedModel
from physgnn.mechanics.body import Body

MODELS: Mapping[str, type[Model]] = {
    "galerkin": GalerkinModel,
    "lifted": LiftedModel,
    "physgnn": PhysGNNModel,
    "reduced": ReducedModel,
}
FITTED = ("galerkin", "reduced")  # no weights to train: `physgnn.learning.fitting`


def build_model(name: str, body: Body, **options: Any) -> Model:
    """Return an untrained model.

    Parameters
    ----------
    name : str
        A row of ``MODELS``.
    body : Body
        What it's made for.
    **options
        The model's own keyword arguments, such as ``configuration=3``.

    Raises
    ------
    InputError
        If there's no such model, the model has no such option, or doesn't know the
        body's elements.
    """
    options = resolved_options(name, options)
    if body.element not in MODELS[name].elements:
        raise InputError(
            f"model '{name}' knows {', '.join(MODELS[name].elements)} elements (got "
            f"{body.element}): train model lifted, or simulate with those"
        )
    return MODELS[name](body, **options)


def resolved_options(name: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return all options of a model: those given, and the defaults of the others.

    Raises
    ------
    InputError
        If there's no such model, or the model has no such option.
    """
    parameters = inspect.signature(MODELS[_checked(name)]).parameters.values()
    known = {p.name: p.default for p in parameters if p.kind is p.KEYWORD_ONLY}
    unknown = sorted(set(options) - set(known))
    if unknown:
        raise InputError(
            f"model '{name}' has no option '{unknown[0]}' (it has: {', '.join(known)})"
        )
    return {**known, **options}


def _checked(name: str) -> str:
    if name not in MODELS:
        raise InputError(f"no model '{name}' (there are: {', '.join(sorted(MODELS))})")
    return name

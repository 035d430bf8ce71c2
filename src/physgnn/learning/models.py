"""The networks there are: one row each.

How a network plugs in is written in :mod:`physgnn.learning.interface`.
"""

from collections.abc import Callable, Mapping

from physgnn.errors import InputError
from physgnn.learning.interface import Body, Model
from physgnn.learning.physgnn_model import PhysGNNModel

MODELS: Mapping[str, Callable[..., Model]] = {
    "physgnn": PhysGNNModel,
}


def build_model(name: str, body: Body, **options: object) -> Model:
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
        If there's no such model, or the model has no such option.
    """
    if name not in MODELS:
        raise InputError(f"no model '{name}' (there are: {', '.join(sorted(MODELS))})")
    try:
        return MODELS[name](body, **options)
    except TypeError as error:
        raise InputError(f"model '{name}' can't take its options: {error}") from error

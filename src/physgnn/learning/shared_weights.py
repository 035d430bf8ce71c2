"""A part of a network that serves several bodies."""

from typing import TypeVar

from torch import nn

from physgnn.errors import InputError

Part = TypeVar("Part", bound=nn.Module)


def part_of_another(own: Part, other: Part, options: str) -> Part:
    """Return another network's part, to take the place of one's own.

    Parameters
    ----------
    own, other : nn.Module
        The same part of two networks.
    options : str
        Names of the options that set its size, for the message.

    Raises
    ------
    InputError
        If they differ in size.
    """
    if _shapes(own) != _shapes(other):
        raise InputError(f"{options} must be those of the other network")
    return other


def _shapes(part: nn.Module) -> list[tuple[int, ...]]:
    return [tuple(weight.shape) for weight in part.parameters()]

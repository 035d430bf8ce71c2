"""The lifted network's weights as those of one that sees everything turned.

Mechanics has no direction of its own: a body turned with its load has its displacement
turned, and mirrored, mirrored. A network learns that from samples seen along axes drawn
at random. To turn its weights is the same as to turn all that it sees, and what it
answers back, and costs next to nothing.
"""

import torch
from torch import Tensor
from torch.func import functional_call

from physgnn.learning.lifted.network import LiftedNetwork, NetworkRegion


def answered(
    network: LiftedNetwork,
    given: tuple[Tensor, Tensor, Tensor, NetworkRegion],
    *,
    any_axes: bool,
) -> tuple[Tensor, Tensor]:
    """Return what a network answers.

    Parameters
    ----------
    network : LiftedNetwork
        It may serve several bodies: whether it learns is its own to say.
    given : tuple
        What its ``forward`` takes.
    any_axes : bool
        Whether it sees all along axes drawn anew while it learns.
    """
    weights = {}
    if any_axes and network.training:
        weights = turned_weights(network, random_axes(given[0].device))
    answer: tuple[Tensor, Tensor] = functional_call(network, weights, given)
    return answer


def random_axes(device: torch.device | str = "cpu") -> Tensor:
    """Return orthonormal rows, (3, 3), uniform among all, mirrored or not.

    The Q of a matrix of normal numbers is uniform once R has a positive diagonal:
    Mezzadri 2007, Notices of the AMS 54.
    """
    q, r = torch.linalg.qr(torch.randn(3, 3))
    drawn: Tensor = q * torch.sign(torch.diagonal(r))
    return drawn.to(device)


def turned_weights(network: LiftedNetwork, axes: Tensor) -> dict[str, Tensor]:
    """Return weights with which a network answers as if it saw all along some axes.

    Parameters
    ----------
    network : LiftedNetwork
        What sees a body along its own axes.
    axes : (3, 3) tensor
        Orthonormal rows.

    Returns
    -------
    dict
        Every weight that changes, by its name.
    """
    one = torch.ones(1, 1, device=axes.device)
    stencil = _side_by_side(one, axes)  # neighbours' mean, and a gradient
    terms = torch.kron(stencil, _of_each(axes, 3))
    # as `_features` has them: gradients; shape, force, imbalance, outward area; log μ
    n_vectors = (network.first.in_features - len(terms) - 1) // 3
    features = _side_by_side(terms, _of_each(axes, n_vectors), one)
    turned = {"first.weight": network.first.weight @ features}
    for k in range(len(network.layers)):
        layer = network.get_parameter(f"layers.{k}.weight")
        message = network.get_parameter(f"messages.{k}.weight")
        own, told = (torch.eye(len(w), device=axes.device) for w in (layer, message))
        around = torch.kron(stencil, told)
        turned[f"layers.{k}.weight"] = layer @ _side_by_side(own, around)
    back = _of_each(axes.T, len(network.last.weight) // 3)
    turned["last.weight"] = back @ network.last.weight
    turned["last.bias"] = back @ network.last.bias
    return turned


def _side_by_side(*blocks: Tensor) -> Tensor:
    """Return a matrix with these on its diagonal."""
    matrix: Tensor = torch.block_diag(*blocks)  # type: ignore[no-untyped-call]
    return matrix


def _of_each(axes: Tensor, n_vectors: int) -> Tensor:
    """Return what turns so many vectors, one after another."""
    return torch.kron(torch.eye(n_vectors, device=axes.device), axes.contiguous())

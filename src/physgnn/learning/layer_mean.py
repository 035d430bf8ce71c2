"""A weighted mean over layers, its rows shared out over threads."""

from collections.abc import Sequence
from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from physgnn.learning.threads import shares, side_by_side


def layer_mean(weight: Tensor, layers: Sequence[Tensor]) -> Tensor:
    """Return Σ wₖ xₖ.

    Parameters
    ----------
    weight : (n_layers, batch, n) tensor
        wₖ.
    layers : sequence of (batch, n, width) tensors
        xₖ.

    Returns
    -------
    (batch, n, width) tensor
    """
    mean: Tensor = _LayerMean.apply(weight, *layers)  # type: ignore[no-untyped-call]
    return mean


class _LayerMean(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *tensors: Tensor) -> Tensor:
        weight, *layers = (tensor.detach() for tensor in tensors)
        mean = torch.empty_like(layers[0])

        def part(rows: slice) -> None:
            here = mean[:, rows]
            torch.mul(layers[0][:, rows], weight[0, :, rows, None], out=here)
            for x, w in zip(layers[1:], weight[1:], strict=True):
                here.addcmul_(x[:, rows], w[:, rows, None])

        side_by_side(part, shares(mean.shape[1], mean.device))
        ctx.save_for_backward(*tensors)
        return mean

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad: Tensor) -> tuple[Tensor, ...]:
        weight, *layers = (tensor.detach() for tensor in ctx.saved_tensors)
        of_weight = torch.empty_like(weight)
        of_layers = [torch.empty_like(x) for x in layers]

        def part(rows: slice) -> None:
            of_mean = grad[:, rows]
            for k, x in enumerate(layers):
                of_weight[k, :, rows] = (of_mean * x[:, rows]).sum(-1)
                w = weight[k, :, rows, None]
                torch.mul(of_mean, w, out=of_layers[k][:, rows])

        side_by_side(part, shares(grad.shape[1], grad.device))
        return of_weight, *of_layers

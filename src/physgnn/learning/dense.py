"""A dense layer: products, bias and PReLU in one go, its rows shared out over threads.

With each operation on all rows in turn, the next would find them gone from cache.
"""

from collections.abc import Sequence
from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from physgnn.learning.threads import shares, side_by_side
from physgnn.learning.workspace import scratch_for


def dense(
    inputs: Sequence[Tensor], matrices: Sequence[Tensor], bias: Tensor, slope: Tensor
) -> Tensor:
    """Return PReLU(Σ xₖ Wₖᵀ + b).

    Parameters
    ----------
    inputs : sequence of (batch, n, columns_k) tensors
        xₖ.
    matrices : sequence of (width, columns_k) tensors
        Wₖ.
    bias, slope : (width,) tensors
        b, and by what PReLU multiplies negative values.

    Returns
    -------
    (batch, n, width) tensor
    """
    keep = torch.is_grad_enabled()
    y: Tensor = _Dense.apply(keep, bias, slope, *inputs, *matrices)  # type: ignore[no-untyped-call]
    return y


class _Dense(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, keep: bool, *tensors: Tensor) -> Tensor:
        bias, slope, xs, matrices = _parts(tensors)
        z = bias.new_empty(*xs[0].shape[:2], len(bias))
        y = torch.empty_like(z) if keep else z

        def part(rows: slice) -> None:
            for sample in range(len(z)):
                total = z[sample, rows]
                torch.addmm(bias, xs[0][sample, rows], matrices[0].t(), out=total)
                for x, matrix in zip(xs[1:], matrices[1:], strict=True):
                    total.addmm_(x[sample, rows], matrix.t())
                below = scratch_for("below zero", total, *total.shape)
                torch.clamp(total, max=0, out=below)
                torch.clamp(total, min=0, out=y[sample, rows]).addcmul_(below, slope)

        side_by_side(part, shares(z.shape[1], z.device))
        if keep:
            ctx.save_for_backward(z, *tensors)
        return y

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad: Tensor) -> tuple[Tensor | None, ...]:
        z, *tensors = ctx.saved_tensors
        bias, slope, xs, matrices = _parts(tensors)
        of_xs = [torch.empty_like(x) for x in xs]

        def part(rows: slice) -> list[Tensor]:
            of_weights = [torch.zeros_like(w) for w in (bias, slope, *matrices)]
            of_bias, of_slope, *of_matrices = of_weights
            for sample in range(len(z)):
                total, of_y = z[sample, rows], grad[sample, rows]
                of_slope += (of_y * total.clamp(max=0)).sum(0)
                of_z = torch.where(total > 0, of_y, slope * of_y)
                of_bias += of_z.sum(0)
                for k, matrix in enumerate(matrices):
                    of_matrices[k].addmm_(of_z.t(), xs[k][sample, rows])
                    torch.mm(of_z, matrix, out=of_xs[k][sample, rows])
            return of_weights

        parts = side_by_side(part, shares(z.shape[1], z.device))
        of_bias, of_slope, *of_matrices = (sum(w) for w in zip(*parts, strict=True))
        return None, of_bias, of_slope, *of_xs, *of_matrices


def _parts(
    tensors: Sequence[Tensor],
) -> tuple[Tensor, Tensor, Sequence[Tensor], Sequence[Tensor]]:
    bias, slope, *others = (tensor.detach() for tensor in tensors)
    half = len(others) // 2
    return bias, slope, others[:half], others[half:]

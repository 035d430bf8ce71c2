"""A dense layer: products, bias and PReLU in one go, its rows shared out over threads.

With each operation on all rows in turn, the next would find them gone from cache.
"""

from collections.abc import Sequence
from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable
from torch.nn.functional import linear

from physgnn.learning.dense_kernels import activate, activate_back
from physgnn.learning.threads import shares, side_by_side


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
    if bias.device.type != "cpu":
        return one_by_one(inputs, matrices, bias, slope)
    keep = torch.is_grad_enabled()
    y: Tensor = _Dense.apply(keep, bias, slope, *inputs, *matrices)  # type: ignore[no-untyped-call]
    return y


class _Dense(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, keep: bool, *tensors: Tensor) -> Tensor:
        bias, slope, xs, matrices = _parts(tensors)
        z = bias.new_empty(*xs[0].shape[:2], len(bias))
        y = torch.empty_like(z) if keep else None

        def part(rows: slice) -> None:
            for sample in range(len(z)):
                here = z[sample, rows]
                torch.mm(xs[0][sample, rows], matrices[0].t(), out=here)
                for x, matrix in zip(xs[1:], matrices[1:], strict=True):
                    here.addmm_(x[sample, rows], matrix.t())
                activated = None if y is None else y[sample, rows].numpy()
                activate(here.numpy(), bias.numpy(), slope.numpy(), activated)

        side_by_side(part, shares(z.shape[1]))
        if y is None:
            return z
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
                of_z = torch.empty_like(z[sample, rows])
                given = z[sample, rows], slope, grad[sample, rows]
                found = of_z, of_bias, of_slope
                activate_back(*(x.numpy() for x in (*given, *found)))
                for k, matrix in enumerate(matrices):
                    of_matrices[k].addmm_(of_z.t(), xs[k][sample, rows])
                    torch.mm(of_z, matrix, out=of_xs[k][sample, rows])
            return of_weights

        parts = side_by_side(part, shares(z.shape[1]))
        of_bias, of_slope, *of_matrices = (sum(w) for w in zip(*parts, strict=True))
        return None, of_bias, of_slope, *of_xs, *of_matrices


def one_by_one(
    inputs: Sequence[Tensor], matrices: Sequence[Tensor], bias: Tensor, slope: Tensor
) -> Tensor:
    """Return what `dense` does, on devices that run no compiled kernels of ours."""
    z = bias + sum(map(linear, inputs, matrices))
    return torch.where(z > 0, z, slope * z)


def _parts(
    tensors: Sequence[Tensor],
) -> tuple[Tensor, Tensor, Sequence[Tensor], Sequence[Tensor]]:
    bias, slope, *others = (tensor.detach() for tensor in tensors)
    half = len(others) // 2
    return bias, slope, others[:half], others[half:]

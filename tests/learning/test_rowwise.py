from collections.abc import Sequence

import pytest
import torch
from torch import Tensor

from physgnn.learning.rowwise import ROWS_A_BLOCK, rowwise


def mixed(rows: Sequence[Tensor], weights: Sequence[Tensor]) -> Tensor:
    return torch.tanh(rows[0] @ weights[0]) * rows[1] + weights[1]


@pytest.mark.parametrize("n", [1, ROWS_A_BLOCK, 2 * ROWS_A_BLOCK + 7])
def test_value_and_gradient_are_those_of_the_function(n: int) -> None:
    generator = torch.Generator().manual_seed(0)
    shapes = [(n, 3), (n, 2), (3, 2), (2,)]
    leaves = [
        torch.randn(shape, generator=generator, dtype=torch.float64).requires_grad_()
        for shape in shapes
    ]
    results = []
    for value in (
        rowwise(mixed, leaves[:2], leaves[2:]),
        mixed(leaves[:2], leaves[2:]),
    ):
        results.append((value, torch.autograd.grad(value.square().sum(), leaves)))
    (value, gradient), (expected, expected_gradient) = results
    torch.testing.assert_close(value, expected)
    torch.testing.assert_close(gradient, expected_gradient)
    with torch.no_grad():
        torch.testing.assert_close(rowwise(mixed, leaves[:2], leaves[2:]), expected)

import pytest
import torch
from torch import Tensor
from torch.nn.functional import linear, prelu

from physgnn.learning.dense import dense, one_by_one


def example(generator: torch.Generator) -> list[Tensor]:
    """Return bias, slope, two inputs and their matrices."""
    shapes = (4,), (4,), (2, 7, 3), (2, 7, 5), (4, 3), (4, 5)
    return [
        torch.randn(shape, generator=generator, dtype=torch.float64).requires_grad_()
        for shape in shapes
    ]


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_equals_products_bias_and_prelu_one_after_the_other(threads: int) -> None:
    bias, slope, x, y, of_x, of_y = tensors = example(torch.Generator().manual_seed(0))
    expected = linear(x, of_x, bias) + linear(y, of_y)
    expected = prelu(expected.flatten(0, 1), slope).view_as(expected)
    towards = torch.randn_like(expected)
    before = torch.get_num_threads()
    torch.set_num_threads(threads)
    try:
        ours = dense((x, y), (of_x, of_y), bias, slope)
        gradients = torch.autograd.grad(ours, tensors, towards)
    finally:
        torch.set_num_threads(before)
    torch.testing.assert_close(ours, expected)
    torch.testing.assert_close(
        gradients, torch.autograd.grad(expected, tensors, towards)
    )


def test_takes_the_first_rows_of_more() -> None:
    """Layers are given views, which needn't lie side by side in memory."""
    bias, slope, x, _, of_x, _ = example(torch.Generator().manual_seed(1))
    torch.testing.assert_close(
        dense([x[:, :4]], [of_x], bias, slope), dense([x], [of_x], bias, slope)[:, :4]
    )


def test_other_devices_do_one_after_the_other_to_the_same() -> None:
    bias, slope, x, y, of_x, of_y = example(torch.Generator().manual_seed(2))
    given = (x, y), (of_x, of_y), bias, slope
    torch.testing.assert_close(one_by_one(*given), dense(*given))


def test_without_a_way_back_it_is_the_same() -> None:
    bias, slope, x, _, of_x, _ = example(torch.Generator().manual_seed(3))
    expected = dense([x], [of_x], bias, slope)
    with torch.inference_mode():
        torch.testing.assert_close(dense([x], [of_x], bias, slope), expected)

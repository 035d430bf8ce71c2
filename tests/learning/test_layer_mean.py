import torch

from physgnn.learning.layer_mean import layer_mean


def test_value_and_gradient_are_those_of_the_weighted_mean() -> None:
    generator = torch.Generator().manual_seed(0)
    weight = torch.rand(3, 2, 9, generator=generator, dtype=torch.float64)
    layers = torch.randn(3, 2, 9, 4, generator=generator, dtype=torch.float64)
    torch.testing.assert_close(
        layer_mean(weight, list(layers)), (weight[..., None] * layers).sum(0)
    )
    given = weight.requires_grad_(), *(x.clone().requires_grad_() for x in layers)
    assert torch.autograd.gradcheck(lambda w, *xs: layer_mean(w, xs), given)

import pytest
import torch

from physgnn.learning.training.objective.losses import LOSSES


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("mean_euclidean", (5 + 1 + 0 + 0) / 4),
        ("mean_square", (25 + 1) / 4),
        ("mean_absolute", (3 + 4 + 1) / 12),
        ("root_mean_square_sample", 13**0.5 / 2),
    ],
)
def test_value(name: str, expected: float) -> None:
    true = torch.ones(2, 2, 3)
    error = torch.tensor([[[3.0, 4.0, 0.0], [0.0, 0.0, -1.0]], [[0.0] * 3] * 2])
    assert float(LOSSES[name](true + error, true)) == pytest.approx(expected)


@pytest.mark.parametrize("name", ["mean_euclidean", "mean_square", "mean_absolute"])
def test_a_perfect_prediction_has_a_finite_gradient(name: str) -> None:
    y = torch.ones(2, 4, 3, requires_grad=True)
    LOSSES[name](y, torch.ones(2, 4, 3)).backward()
    assert y.grad is not None
    assert torch.isfinite(y.grad).all()


def test_the_relative_loss_weighs_small_loads_as_much_as_large_ones() -> None:
    true = torch.rand(3, 50, 3, generator=torch.Generator().manual_seed(0))
    scale = torch.tensor([1.0, 10.0, 100.0])[:, None, None]
    found = LOSSES["relative_sample"](1.2 * scale * true, scale * true)
    assert float(found) == pytest.approx(0.2, rel=1e-5)

import pytest
import torch
from torch import Tensor

from physgnn.learning import lstm
from physgnn.learning.lstm import Weights, lstm_scores

WIDTH, SIZE, STEPS = 5, 8, 3


def textbook(sequence: list[Tensor], weights: Weights) -> Tensor:
    """Score by the LSTM's equations as they are printed."""
    hidden = cell = sequence[0].new_zeros(len(sequence[0]), SIZE)
    scores = []
    for x in sequence:
        z = torch.cat([x, hidden], dim=1) @ weights.matrix.t() + weights.bias
        f, i, g, o = z.chunk(4, dim=1)
        cell = f.sigmoid() * cell + i.sigmoid() * (g / 2).tanh()  # kept doubled
        hidden = o.sigmoid() * cell.tanh()
        scores.append(hidden @ weights.score)
    return torch.stack(scores, dim=1)


def example(n_rows: int, dtype: torch.dtype) -> tuple[list[Tensor], Weights]:
    generator = torch.Generator().manual_seed(n_rows)
    shapes = [(4 * SIZE, WIDTH + SIZE), (4 * SIZE,), (SIZE,)] + [
        (n_rows, WIDTH)
    ] * STEPS
    tensors = [
        torch.randn(s, generator=generator, dtype=dtype).requires_grad_()
        for s in shapes
    ]
    return tensors[3:], Weights(*tensors[:3])


@pytest.fixture(params=[1, 2])
def threads(request: pytest.FixtureRequest) -> None:
    before = torch.get_num_threads()
    torch.set_num_threads(request.param)
    yield
    torch.set_num_threads(before)


@pytest.mark.usefixtures("threads")
@pytest.mark.parametrize("keep", [True, False])
@pytest.mark.parametrize("n_rows", [1, 40, 101])
def test_scores_and_gradients_are_the_textbooks(
    monkeypatch: pytest.MonkeyPatch, n_rows: int, keep: bool
) -> None:
    monkeypatch.setattr(lstm, "ROWS_A_BLOCK", 20)  # blocks and parts that don't divide
    sequence, weights = example(n_rows, torch.float64)
    scores = lstm_scores(sequence, weights, keep=keep)
    expected = textbook(sequence, weights)
    torch.testing.assert_close(scores, expected)
    towards = torch.randn_like(scores)
    inputs = [*weights, *sequence]
    torch.testing.assert_close(
        torch.autograd.grad(scores, inputs, towards),
        torch.autograd.grad(expected, inputs, towards),
    )


def test_float32_is_as_near_as_its_rounding() -> None:
    sequence, weights = example(300, torch.float32)
    double = Weights(*(w.double() for w in weights))
    exact = textbook([10 * x.double() for x in sequence], double)
    scores = lstm_scores([10 * x for x in sequence], weights)
    torch.testing.assert_close(scores.double(), exact, rtol=0, atol=3e-5)


def test_bfloat16_products_err_as_bfloat16_does() -> None:
    sequence, weights = example(300, torch.float32)
    exact = textbook(sequence, weights)
    with torch.no_grad():
        rough = lstm_scores(
            sequence, weights._replace(matrix=weights.matrix.bfloat16())
        )
    error = (rough - exact).abs().mean() / exact.abs().mean()
    assert 1e-4 < error < 2e-2

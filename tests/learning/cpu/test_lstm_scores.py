from collections.abc import Iterator
from itertools import pairwise

import pytest
import torch
from torch import Tensor

from physgnn.learning.cpu import blocks as lstm_blocks
from physgnn.learning.cpu.common_layers import lstm_scores, read_shared
from physgnn.learning.cpu.lstm_inputs import Weights
from physgnn.learning.cpu.lstm_scores import Way

WIDTH, SIZE, STEPS = 5, 8, 3


def textbook(sequence: list[Tensor], weights: Weights) -> Tensor:
    """Score by the LSTM's equations as they are printed."""
    hidden = cell = sequence[0].new_zeros(*sequence[0].shape[:2], SIZE)
    scores = []
    for x in sequence:
        z = torch.cat([x, hidden], dim=2) @ weights.matrix.t() + weights.bias
        f, i, g, o = z.chunk(4, dim=2)
        cell = f.sigmoid() * cell + i.sigmoid() * (g / 2).tanh()  # kept doubled
        hidden = o.sigmoid() * cell.tanh()
        scores.append(hidden @ weights.score)
    return torch.stack(scores)


def random_weights(generator: torch.Generator, dtype: torch.dtype) -> Weights:
    shapes = (4 * SIZE, WIDTH + SIZE), (4 * SIZE,), (SIZE,)
    return Weights(*(random(generator, dtype, *shape) for shape in shapes))


def random(generator: torch.Generator, dtype: torch.dtype, *shape: int) -> Tensor:
    return torch.randn(shape, generator=generator, dtype=dtype).requires_grad_()


def example(
    n_rows: int, dtype: torch.dtype, batch: int = 2
) -> tuple[list[Tensor], Weights]:
    generator = torch.Generator().manual_seed(n_rows)
    weights = random_weights(generator, dtype)
    shape = batch, n_rows, WIDTH
    return [random(generator, dtype, *shape) for _ in range(STEPS)], weights


@pytest.fixture(params=[1, 2])
def threads(request: pytest.FixtureRequest) -> None:
    before = torch.get_num_threads()
    torch.set_num_threads(request.param)
    yield
    torch.set_num_threads(before)


@pytest.fixture
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Make blocks and parts that don't divide."""
    monkeypatch.setattr(lstm_blocks, "ROWS_A_BLOCK", 20)
    lstm_blocks.blocks_of.cache_clear()
    yield
    lstm_blocks.blocks_of.cache_clear()


def check(scores: Tensor, expected: Tensor, inputs: list[Tensor]) -> None:
    torch.testing.assert_close(scores, expected)
    towards = torch.randn_like(scores)
    torch.testing.assert_close(
        torch.autograd.grad(scores, inputs, towards),
        torch.autograd.grad(expected, inputs, towards),
    )


@pytest.mark.usefixtures("threads", "small_blocks")
@pytest.mark.parametrize("keep", [True, False])
@pytest.mark.parametrize("n_rows", [1, 40, 101])
def test_scores_and_gradients_are_the_textbooks(n_rows: int, keep: bool) -> None:
    sequence, weights = example(n_rows, torch.float64)
    scores = lstm_scores(sequence, weights, way=Way(keep=keep))
    check(scores, textbook(sequence, weights), [*weights, *sequence])


@pytest.mark.usefixtures("threads", "small_blocks")
@pytest.mark.parametrize("keep", [True, False])
@pytest.mark.parametrize(
    "counts", [(12, 31, 50), (50, 31, 12), (30, 30, 50), (50, 50, 20), (7, 50, 50)]
)
def test_what_samples_have_in_common_may_be_read_once(
    counts: tuple[int, ...], keep: bool
) -> None:
    generator, n = torch.Generator().manual_seed(sum(counts)), max(counts)
    weights = random_weights(generator, torch.float64)
    own = [random(generator, torch.float64, 3, k, WIDTH) for k in counts]
    common = [random(generator, torch.float64, n - k, WIDTH) for k in counts]
    whole = [
        torch.cat([x, y.expand(3, -1, -1)], dim=1)
        for x, y in zip(own, common, strict=True)
    ]
    way = Way(keep=keep)
    scores = lstm_scores(own, weights, read_shared(common, weights, way), way)
    there = [y for y in common if len(y)]
    check(scores, textbook(whole, weights), [*weights, *own, *there])


def test_float32_is_as_near_as_its_rounding() -> None:
    sequence, weights = example(300, torch.float32)
    double = Weights(*(w.double() for w in weights))
    exact = textbook([10 * x.double() for x in sequence], double)
    scores = lstm_scores([10 * x for x in sequence], weights)
    torch.testing.assert_close(scores.double(), exact, rtol=0, atol=3e-5)


def relative(rough: Tensor, exact: Tensor) -> float:
    difference = (rough - exact).detach().abs().mean()
    return float(difference / exact.detach().abs().mean())


@pytest.mark.parametrize("keep", [True, False])
def test_bfloat16_products_and_gradients_err_as_bfloat16_does(keep: bool) -> None:
    sequence, weights = example(300, torch.float32)
    exact = textbook(sequence, weights)
    rough = lstm_scores(sequence, weights, way=Way(torch.bfloat16, keep))
    assert 1e-4 < relative(rough, exact) < 2e-2
    inputs, towards = [*weights, *sequence], torch.randn_like(exact)
    for ours, expected in zip(
        torch.autograd.grad(rough, inputs, towards),
        torch.autograd.grad(exact, inputs, towards),
        strict=True,
    ):
        assert ours.dtype == torch.float32
        assert 1e-5 < relative(ours, expected) < 3e-2


def test_blocks_cover_every_point_once_and_their_states_do_not_overlap() -> None:
    layout = lstm_blocks.Layout(SIZE, torch.bfloat16, torch.float32)
    parts, n_bytes = lstm_blocks.blocks_of((300, 1500, 2000), 2, layout, 3)
    blocks = sorted((b for part in parts for b in part), key=lambda b: b.offset)
    assert sum(map(len, blocks)) == 2 * 2000
    assert {b.first for b in blocks} == {0, 1, 2}
    for block, after in pairwise(blocks):
        assert block.offset + layout.n_bytes(block) == after.offset
    assert blocks[-1].offset + layout.n_bytes(blocks[-1]) == n_bytes


def test_threads_get_about_as_much_to_do() -> None:
    layout = lstm_blocks.Layout(SIZE, torch.float32, torch.float32)
    parts, n_bytes = lstm_blocks.blocks_of((455, 1150, 2026), 1, layout, 2)
    for part in parts:
        assert sum(map(layout.n_bytes, part)) == pytest.approx(n_bytes / 2, rel=0.15)

"""Slices, tokens and back, as the paper's sums say; no order of points matters."""

import torch

from physgnn.learning.mesh_networks.transolver import (
    EMPTY,
    PhysicsAttention,
    Transolver,
)

WIDTH, HEADS, SLICES, N_POINTS = 8, 2, 3, 11


def states() -> torch.Tensor:
    torch.manual_seed(0)
    return torch.randn(2, N_POINTS, WIDTH)


def test_attention_is_the_papers_slice_by_slice() -> None:
    x = states()
    attention = PhysicsAttention(WIDTH, HEADS, SLICES)
    torch.nn.init.constant_(attention.temperature, 0.7)
    found, part = attention(x), WIDTH // HEADS
    together = torch.zeros(2, N_POINTS, WIDTH)
    for sample in range(2):
        for head in range(HEADS):
            columns = slice(head * part, (head + 1) * part)
            of_weights = attention.to_weights(x[sample])[:, columns]
            of_values = attention.to_values(x[sample])[:, columns]
            weights = torch.softmax(attention.slice(of_weights) / 0.7, dim=-1)
            tokens = torch.stack(
                [
                    (weights[:, k, None] * of_values).sum(0)
                    / (weights[:, k].sum() + EMPTY)
                    for k in range(SLICES)
                ]
            )
            scores = attention.query(tokens) @ attention.key(tokens).T / part**0.5
            mixed = torch.softmax(scores, dim=-1) @ attention.value(tokens)
            together[sample, :, columns] = weights @ mixed
    torch.testing.assert_close(found, attention.out(together))


def test_points_may_come_in_any_order() -> None:
    x, order = states(), torch.randperm(N_POINTS)
    network = Transolver(WIDTH, 3, width=8, layers=2, heads=2, slices=4).eval()
    torch.testing.assert_close(network(x[:, order]), network(x)[:, order])


def test_every_point_hears_of_every_other() -> None:
    x = states()
    network = Transolver(WIDTH, 3, width=8, layers=1, heads=2, slices=4).eval()
    before = network(x)
    x[:, 0] += 1.0
    assert (network(x) != before).any(dim=-1).all()

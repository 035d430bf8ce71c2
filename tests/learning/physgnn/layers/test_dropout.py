import torch

from physgnn.learning.physgnn.layers.dropout import SampleDropout, seed_dropout

X = torch.ones(6, 50, 40)


def test_masks_follow_from_the_seeds_however_a_batch_is_cut() -> None:
    dropout = SampleDropout(0.1)
    seed_dropout(dropout, range(6))
    whole = dropout(X.flatten(0, 1)).view_as(X)
    for part in (slice(0, 2), slice(1, 6, 2)):
        seed_dropout(dropout, range(6)[part])
        assert torch.equal(dropout(X[part]), whole[part])
    assert not torch.equal(whole[0], whole[1])


def test_drops_the_part_asked_for_and_keeps_the_mean() -> None:
    dropout = SampleDropout(0.25)
    seed_dropout(dropout, range(6))
    y = dropout(X)
    assert abs(float((y == 0).float().mean()) - 0.25) < 0.02
    assert abs(float(y.mean()) - 1.0) < 0.02


def test_does_nothing_in_evaluation() -> None:
    assert SampleDropout(0.5).eval()(X) is X

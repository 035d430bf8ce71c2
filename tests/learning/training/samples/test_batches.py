from itertools import chain

import pytest

from physgnn.learning.training.samples.batches import EpochOrder, Share


@pytest.mark.parametrize("processes", [1, 2, 3])
@pytest.mark.parametrize("n_samples", [23, 24, 25])
def test_processes_share_every_batch_of_one_process_out(
    processes: int, n_samples: int
) -> None:
    whole = EpochOrder(n_samples, 8, seed=1)
    shares = [
        EpochOrder(n_samples, 8, seed=1, share=Share(rank, processes))
        for rank in range(processes)
    ]
    for order in (whole, *shares):
        order.set_epoch(4)
    together = [list(chain(*parts)) for parts in zip(*shares, strict=True)]
    expected = [batch for batch in whole if len(batch) >= processes]
    assert [sorted(batch) for batch in together] == [sorted(b) for b in expected]
    assert all(len(order) == len(list(order)) for order in (whole, *shares))


def test_another_order_every_epoch_and_the_same_again() -> None:
    order = EpochOrder(20, 4, seed=1)
    first = list(order)
    order.set_epoch(1)
    assert list(order) != first
    order.set_epoch(0)
    assert list(order) == first
    assert sorted(chain(*first)) == list(range(20))

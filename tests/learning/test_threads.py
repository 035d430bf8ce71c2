import torch
from torch import Tensor

from physgnn.learning.threads import side_by_side


def square(part: Tensor) -> Tensor:
    assert torch.get_num_threads() == 1
    return part.square()


def test_results_come_in_order_whatever_mode_is_on() -> None:
    threads = torch.get_num_threads()
    parts = list(torch.arange(6.0, requires_grad=True).chunk(3))
    for mode in (torch.no_grad(), torch.inference_mode()):
        with mode:
            squares = side_by_side(square, parts)
            assert torch.cat(squares).tolist() == [0, 1, 4, 9, 16, 25]
            assert squares[0].is_inference() == torch.is_inference_mode_enabled()
    assert torch.get_num_threads() == threads
    assert not side_by_side(square, parts)[0].requires_grad


def test_one_part_needs_no_thread() -> None:
    assert side_by_side(lambda part: part + 1, [2]) == [3]

import platform
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest
import torch

from physgnn.learning.lstm import Way
from physgnn.learning.lstm_data import Weights
from physgnn.learning.lstm_shared import lstm_scores
from physgnn.learning.workspace import give_back, reused_memory, scratch, take


def test_what_was_given_back_is_used_again() -> None:
    with reused_memory():
        small, large = take(10), take(100)
        give_back(large)
        give_back(small)
        assert take(8) is small
        assert take(8) is large
        assert take(8) is not small


def test_a_buffer_that_is_too_small_makes_room_for_one_that_is_not() -> None:
    with reused_memory():
        small = take(10)
        give_back(small)
        assert len(take(20)) == 20
        assert take(5) is not small


def test_nothing_is_kept_outside() -> None:
    buffer = take(10)
    give_back(buffer)
    assert take(10) is not buffer


def test_going_back_twice_is_refused_once_the_memory_was_used_again() -> None:
    shapes = (16, 7), (16,), (4,)
    weights = Weights(*(torch.randn(shape, requires_grad=True) for shape in shapes))
    inputs = [torch.randn(2, 5, 3) for _ in range(2)]
    with reused_memory():
        scores = lstm_scores(inputs, weights, way=Way())
        scores.sum().backward(retain_graph=True)
        lstm_scores(inputs, weights, way=Way())
        with pytest.raises(RuntimeError, match="modified by an inplace operation"):
            scores.sum().backward()


def test_a_thread_works_in_one_buffer_that_grows() -> None:
    with torch.inference_mode():
        buffer = scratch(100)
        assert scratch(50).data_ptr() == buffer.data_ptr()
    larger = scratch(len(buffer) + 1)
    assert len(larger) > len(buffer)
    larger.fill_(1)  # written to in training as well
    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(scratch, 1).result().data_ptr() != larger.data_ptr()


def test_uses_of_scratch_have_buffers_of_their_own() -> None:
    assert scratch(10, "inputs").data_ptr() != scratch(10, "states").data_ptr()


FRESH_PAGES = """
import resource
import torch
from physgnn.learning.workspace import keep_freed_memory

def pages():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    blocks = [torch.ones(3 * 2**18) for _ in range(8)]  # 3 MB each
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before

keep_freed_memory()
print([pages() for _ in range(6)][-1])
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="asks glibc to keep it")
def test_freed_memory_is_kept_for_who_needs_some_next() -> None:
    """Else each round takes 6000 pages, unless an import happened to free as much."""
    code = [sys.executable, "-c", FRESH_PAGES]
    printed = subprocess.run(code, capture_output=True, check=True).stdout
    assert int(printed) < 100

from pathlib import Path

import numpy as np
import pytest
import torch

from physgnn.dataset.storage.store import Store
from physgnn.learning.models import build_model
from physgnn.learning.training.samples.batches import Samples
from physgnn.learning.training.samples.sample_cache import SampleCache

VALUES = torch.arange(12.0).reshape(4, 3)


def test_gives_back_bit_for_bit_what_was_put(tmp_path: Path) -> None:
    with SampleCache(tmp_path) as cache:
        for i in range(5):
            cache.put((i, 1), VALUES + i / 3)
        for i in reversed(range(5)):
            assert torch.equal(cache.get((i, 1)), VALUES + i / 3)
        assert cache.get((0, 0)) is None


def test_leaves_no_file(tmp_path: Path) -> None:
    with SampleCache(tmp_path) as cache:
        cache.put((0, 0), VALUES)
        assert not any(tmp_path.iterdir())
    assert not any(tmp_path.iterdir())


def test_keeps_only_what_fits(tmp_path: Path) -> None:
    with SampleCache(tmp_path, max_bytes=100) as cache:
        for i in range(4):
            cache.put((i, 0), VALUES)  # 48 bytes each
        kept = [cache.get((i, 0)) is not None for i in range(4)]
    assert kept == [True, True, False, False]


def test_a_sample_is_made_once(
    store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = build_model("physgnn", store.body, width=8)
    samples = np.array([[2, 1], [0, 3]])
    plain = Samples(store, samples, model)
    expected = [plain[i] for i in range(2)]
    made = []
    encode = model.encode
    monkeypatch.setattr(model, "encode", lambda case: made.append(1) or encode(case))
    with SampleCache(tmp_path) as cache:
        cached = Samples(store, samples, model, cache)
        for _ in range(3):
            for i in range(2):
                for ours, theirs in zip(cached[i], expected[i], strict=True):
                    assert torch.equal(ours, theirs)
    assert len(made) == 2

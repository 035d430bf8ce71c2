"""Splits cover all converged samples once, and hold out what they say."""

import itertools
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from physgnn.dataset import (
    SPLITS,
    Split,
    Store,
    split_node,
    split_path,
    split_published,
)
from physgnn.errors import InputError

NewStore = Callable[..., Store]


class Shape:
    """A store's shape: what a split looks at, without the disk."""

    def __init__(self, samples: np.ndarray, n_paths: int, node_step: int = 1) -> None:
        self._samples, self.n_paths, self._node_step = samples, n_paths, node_step
        self.training_paths = 0
        self.mesh = type("Mesh", (), {"n_points": n_paths})

    def samples(self) -> np.ndarray:
        return self._samples

    def load_path(self, i: int) -> object:
        return type("Path", (), {"nodes": np.array([i // self._node_step])})


def complete(n_paths: int, n_levels: int, node_step: int = 1) -> Shape:
    return Shape(np.argwhere(np.ones((n_paths, n_levels))), n_paths, node_step)


def rows(samples: np.ndarray) -> list[tuple[int, int]]:
    return [tuple(row) for row in samples.tolist()]


@settings(max_examples=60, deadline=None)
@given(
    name=st.sampled_from(sorted(SPLITS)),
    mask=st.integers(3, 12).flatmap(
        lambda n: st.lists(
            st.lists(st.booleans(), min_size=4, max_size=4), min_size=n, max_size=n
        )
    ),
    seed=st.integers(0, 1000),
)
def test_every_converged_sample_is_used_once(
    name: str, mask: list[list[bool]], seed: int
) -> None:
    samples = np.argwhere(np.array(mask))
    store = Shape(samples, len(mask))
    try:
        split = SPLITS[name](store, seed=seed)
    except InputError:
        few = len(np.unique(samples[:, 0])) if name != "published" else len(samples)
        assert few < (3 if name != "published" else 10)
        return
    parts = [rows(part) for part in (split.train, split.validation, split.test)]
    assert sorted(itertools.chain(*parts)) == rows(samples)
    if name != "published":
        train, validation, test = ({path for path, _ in part} for part in parts)
        assert not train & validation
        assert not train & test
        assert not validation & test


def test_published_is_pythons_shuffle() -> None:
    split = split_published(complete(165, 30))
    assert [len(split.train), len(split.validation), len(split.test)] == [
        3465,
        990,
        495,
    ]
    # random.Random(1).shuffle of range(4950) begins so:
    first = split.train[:3] @ [30, 1]
    assert first.tolist() == [2442, 2320, 3022]


def test_published_leaks_neighbours_and_path_does_not() -> None:
    store = complete(165, 30)
    for split, leaks in ((split_published(store), True), (split_path(store), False)):
        shared = np.isin(split.test[:, 0], split.train[:, 0]).mean()
        assert shared == (1.0 if leaks else 0.0)


def test_path_counts() -> None:
    split = split_path(complete(165, 30))
    counts = [
        len(np.unique(p[:, 0])) for p in (split.train, split.validation, split.test)
    ]
    assert counts == [116, 33, 16]
    assert sum(counts) == 165


def test_seeds_differ_and_repeat() -> None:
    store = complete(40, 5)
    assert rows(split_path(store, 1).test) == rows(split_path(store, 1).test)
    assert rows(split_path(store, 1).test) != rows(split_path(store, 2).test)


def test_node_holds_out_nodes(new_store: NewStore, made_up: Callable) -> None:
    store = new_store(n_paths=12, node_step=2)
    for i in range(12):
        store.write(i, made_up(store, i))
    split = split_node(store)
    loaded = [
        {int(store.load_path(i).nodes[0]) for i in np.unique(part[:, 0])}
        for part in (split.train, split.validation, split.test)
    ]
    assert [len(nodes) for nodes in loaded] == [4, 1, 1]
    assert len(set.union(*loaded)) == 6


def test_node_is_impossible_if_all_paths_share_a_node() -> None:
    with pytest.raises(InputError, match="three groups of load paths that share"):
        split_node(complete(8, 3, node_step=8))


def test_split_checks_itself() -> None:
    a, b = np.array([[0, 0]]), np.array([[0, 1]])
    with pytest.raises(InputError, match="names a sample twice"):
        Split("mine", a, b, a)
    with pytest.raises(InputError, match="needs test samples"):
        Split("mine", a, b, np.empty((0, 2)))
    Split("mesh", a, b[:0], b[:0])
    with pytest.raises(InputError, match=r"shape \(n, 2\)"):
        Split("mine", a, b, np.array([1, 2]))


@pytest.mark.parametrize("name", sorted(SPLITS))
def test_paths_for_training_alone_change_nothing_that_is_held_out(name: str) -> None:
    """Nodes 0, 1, … take turns, so that of eight further paths each has one."""
    own, levels = 12, 3
    alone = SPLITS[name](complete(own, levels))
    longer = complete(own + 8, levels)
    longer.training_paths = 8
    if name == "node":
        longer.load_path = lambda i: type("Path", (), {"nodes": np.array([i % own])})
    split = SPLITS[name](longer)
    assert rows(split.validation) == rows(alone.validation)
    assert rows(split.test) == rows(alone.test)
    added = [row for row in rows(split.train) if row[0] >= own]
    assert [row for row in rows(split.train) if row[0] < own] == rows(alone.train)
    held = {path for path, _ in rows(alone.validation) + rows(alone.test)}
    wanted = [i for i in range(own, own + 8) if name != "node" or i % own not in held]
    assert added == [(i, level) for i in wanted for level in range(levels)]
    assert len(wanted) > 0 and (name != "node" or len(wanted) < 8)


@given(counts=st.tuples(*[st.integers(1, 40)] * 3), at_most=st.integers(1, 50))
def test_thinned_keeps_training_and_spreads_what_is_held_out(
    counts: tuple[int, int, int], at_most: int
) -> None:
    """No two of those that stay are further apart than the mean distance and one."""
    samples = complete(10, 12).samples()
    parts = np.split(samples, np.cumsum(counts))[:3]
    split = Split("mine", *(part[::-1] for part in parts))
    thinned = split.thinned(at_most)
    assert rows(thinned.train) == rows(split.train)
    for before, after in (
        (parts[1], thinned.validation), (parts[2], thinned.test)
    ):  # fmt: skip
        assert len(after) == min(len(before), at_most)
        places = sorted(rows(before).index(row) for row in rows(after))
        gaps = np.diff(places)
        assert (gaps <= len(before) / max(len(after) - 1, 1) + 1).all()

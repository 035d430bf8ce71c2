"""Which samples train, validate and test a network: the published way, and honest ways.

Load paths of a dataset that are for training alone are never held out.

Neighbouring levels of one load path are almost the same sample, so a split that mixes
them measures interpolation (docs/results/leaking_split.md). `split_path` holds out
whole paths and `split_node` whole sets of loaded nodes: of the published datasets only
the first has such sets, since all paths of the second load the same hundred nodes. To
hold out whole meshes takes another store.
"""

import random
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from physgnn.arrays import IntArray
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError

TRAIN, VALIDATION, TEST = 0.7, 0.2, 0.1  # as published
MESH = "mesh"


@dataclass(frozen=True, eq=False)
class Split:
    """Samples by use.

    Parameters
    ----------
    name : str
        How it was made; one named ``mesh`` takes or holds out a whole store, so that
        its other parts are empty.
    train, validation, test : (n, 2) integer arrays
        (path, level) of every sample; no sample is in two of them.

    Raises
    ------
    InputError
        If a part is empty or of another shape, or a sample is in two parts.
    """

    name: str
    train: IntArray
    validation: IntArray
    test: IntArray

    def __post_init__(self) -> None:
        for part in ("train", "validation", "test"):
            samples = np.asarray(getattr(self, part), dtype=np.int64)
            may_be_empty = self.name == MESH
            if samples.shape != (len(samples), 2) or not (len(samples) or may_be_empty):
                raise InputError(
                    f"split '{self.name}' needs {part} samples of shape (n, 2), n ≥ 1 "
                    f"(got {samples.shape}): simulate more load paths"
                )
            object.__setattr__(self, part, samples)
        together = np.concatenate([self.train, self.validation, self.test])
        if len(np.unique(together, axis=0)) < len(together):
            raise InputError(f"split '{self.name}' names a sample twice")

    def thinned(self, at_most: int) -> "Split":
        """Return the split with at most so many samples to validate and to test on.

        Those that stay are spread evenly over paths and levels.
        """
        parts = (self.validation, self.test)
        validation, test = (_spread(part, at_most) for part in parts)
        return replace(self, validation=validation, test=test)


def _spread(samples: IntArray, at_most: int) -> IntArray:
    if len(samples) <= at_most:
        return samples
    ordered = samples[np.lexsort((samples[:, 1], samples[:, 0]))]
    places = np.linspace(0, len(ordered) - 1, at_most)
    thinned: IntArray = ordered[np.round(places).astype(np.int64)]
    return thinned


def split_published(store: Store, seed: int = 1) -> Split:
    """Shuffle all samples and cut them 70/20/10, whatever their path.

    With all samples converged and seed 1 this is the published split: Python's
    ``random.Random(1).shuffle`` of the samples path by path, level by level.

    Parameters
    ----------
    store : Store
        The dataset; its converged samples are split.
    seed : int
        Of the draw; the same seed gives the same split.

    Returns
    -------
    Split
        Samples for training, validation and testing: rows of (path, level).
    """
    samples, further = _own_and_further(store)
    order = list(range(len(samples)))
    random.Random(seed).shuffle(order)
    ends = np.floor(np.array([TRAIN, TRAIN + VALIDATION]) * len(order) + 1e-9)
    train, *others = np.split(samples[order], ends.astype(int))
    return Split("published", np.concatenate([train, further]), *others)


def split_path(store: Store, seed: int = 0) -> Split:
    """Hold out whole load paths: 20 % for validation, 10 % for testing.

    Parameters
    ----------
    store : Store
        The dataset; its converged samples are split.
    seed : int
        Of the draw; the same seed gives the same split.

    Returns
    -------
    Split
        Samples for training, validation and testing: rows of (path, level).
    """
    return _split_groups("path", store, np.arange(store.n_paths), seed)


def split_node(store: Store, seed: int = 0) -> Split:
    """Hold out loaded nodes: no test path loads a node that a training path loads.

    Parameters
    ----------
    store : Store
        The dataset; its converged samples are split.
    seed : int
        Of the draw; the same seed gives the same split.

    Returns
    -------
    Split
        Samples for training, validation and testing: rows of (path, level).

    Raises
    ------
    InputError
        If the paths hang together, each sharing a node with another, in fewer than
        three groups; as when all paths load all nodes.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    nodes = [store.load_path(i).nodes for i in range(store.n_paths)]
    path = np.repeat(np.arange(store.n_paths), [len(of_path) for of_path in nodes])
    vertex = store.n_paths + np.concatenate(nodes)  # paths and nodes in one graph
    size = store.n_paths + store.mesh.n_points
    links = coo_array((np.ones(len(path)), (path, vertex)), shape=(size, size))
    _, group = connected_components(links, directed=False)
    return _split_groups("node", store, group[: store.n_paths], seed)


SPLITS: dict[str, Callable[..., Split]] = {
    "published": split_published,
    "path": split_path,
    "node": split_node,
}


def named_split(name: str, store: Store) -> Split:
    """Return a split by its name; InputError names those there are.

    Parameters
    ----------
    name : str
        A row of ``SPLITS``.
    store : Store
        The dataset; its converged samples are split.

    Returns
    -------
    Split
        Samples for training, validation and testing: rows of (path, level).
    """
    if name not in SPLITS:
        raise InputError(f"no split '{name}' (there are: {', '.join(sorted(SPLITS))})")
    return SPLITS[name](store)


def _split_groups(name: str, store: Store, group: IntArray, seed: int) -> Split:
    """Cut a shuffle of the groups of paths that have samples.

    Paths for training alone are of the training part, unless their group is held out.
    """
    samples, further = _own_and_further(store)
    present = np.unique(group[samples[:, 0]])
    n = len(present)
    if n < 3:
        raise InputError(
            f"split '{name}' needs three groups of load paths that share nothing, for "
            f"training, validation and testing (got {n}); use another split, or "
            "simulate paths that load fewer nodes each"
        )
    np.random.default_rng(seed).shuffle(present)
    n_test = max(round(TEST * n), 1)
    n_validation = max(round(VALIDATION * n), 1)
    cut = [n - n_test - n_validation, n - n_test]
    parts = np.split(present, cut)
    train, *others = (samples[np.isin(group[samples[:, 0]], p)] for p in parts)
    held_out = np.isin(group[further[:, 0]], np.concatenate(parts[1:]))
    return Split(name, np.concatenate([train, further[~held_out]]), *others)


def _own_and_further(store: Store) -> tuple[IntArray, IntArray]:
    """Return the samples that may be held out, and those for training alone."""
    samples = store.samples()
    own = samples[:, 0] < store.n_paths - store.training_paths
    return samples[own], samples[~own]

"""A load's numbers: what they say, and how they follow the load."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.dataset.storage.store import Store
from physgnn.learning.classical.learners.load_features import LoadFeatures
from physgnn.mechanics.loads.paths import LoadCase


@pytest.fixture(scope="module")
def features(store: Store) -> LoadFeatures:
    return LoadFeatures.of(store, store.samples())


@given(factor=st.floats(0.1, 10), path=st.integers(0, 7))
def test_all_but_the_place_grow_with_the_load(
    store: Store, features: LoadFeatures, factor: float, path: int
) -> None:
    case = store.load_case(path, 3)
    more = LoadCase(case.nodes, factor * case.forces)
    before, after = features.of_case(case), features.of_case(more)
    grows = np.ones(len(before), dtype=bool)
    grows[3:6] = False
    np.testing.assert_allclose(after[grows], factor * before[grows], rtol=1e-4)
    np.testing.assert_allclose(after[3:6], before[3:6], rtol=1e-5)


def test_resultant_and_place_of_a_single_force(
    store: Store, features: LoadFeatures
) -> None:
    case = LoadCase(np.array([5]), np.array([[0.0, 3.0, -4.0]]))
    found = features.of_case(case)
    np.testing.assert_allclose(found[:3], [0, 3, -4])
    np.testing.assert_allclose(found[3:6], store.mesh.points[5], rtol=1e-6)


def test_components_tell_training_loads_apart(
    store: Store, features: LoadFeatures
) -> None:
    """Orthonormal, and spanning: lengths of loads and of their shares agree."""
    flat = features.components.reshape(len(features.components), -1)
    spanning = flat[flat.any(axis=1)]
    np.testing.assert_allclose(spanning @ spanning.T, np.eye(len(spanning)), atol=1e-9)
    for path in range(store.n_paths):
        case = store.load_case(path, 1)
        shares = features.of_case(case)[6:]
        length = np.linalg.norm(case.forces)
        assert np.linalg.norm(shares) == pytest.approx(length, rel=1e-5)


def test_nodes_see_the_nearest_force(store: Store, features: LoadFeatures) -> None:
    case = store.load_case(0, 2)
    nodes = np.arange(store.mesh.n_points)
    columns = features.of_nodes(case, nodes)
    places = store.mesh.points
    apart = np.linalg.norm(places[:, None] - places[case.nodes], axis=2)
    np.testing.assert_allclose(columns[:, :3], places, rtol=1e-6)
    np.testing.assert_allclose(
        np.linalg.norm(columns[:, 3:6], axis=1), apart.min(axis=1), atol=1e-5
    )
    on_loaded = columns[case.nodes]
    np.testing.assert_allclose(on_loaded[:, 6:], case.forces, rtol=1e-6)

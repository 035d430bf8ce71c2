from pathlib import Path

import numpy as np
import pytest

from physgnn.dataset.presets import PRESETS
from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.physgnn.features import load_features
from physgnn.learning.physgnn.model import PhysGNNModel
from physgnn.learning.physgnn.normalization import Normalizer, force_statistics
from physgnn.mechanics.body import Body


def every_column(store: Store, samples: np.ndarray) -> np.ndarray:
    n_points = store.mesh.n_points
    return np.concatenate(
        [load_features(store.load_case(p, k), n_points) for p, k in samples]
    )


def test_statistics_equal_those_of_all_rows_laid_out(store: Store) -> None:
    rows = every_column(store, store.samples())
    mean, std = force_statistics(store, store.samples())
    np.testing.assert_allclose(mean, rows.mean(axis=0), atol=1e-15)
    np.testing.assert_allclose(std, rows.std(axis=0, ddof=1), rtol=1e-10)


def test_standardised_columns_have_mean_zero_and_deviation_one(store: Store) -> None:
    normalizer = Normalizer()
    normalizer.fit(store, store.samples())
    rows = normalizer.standardise(every_column(store, store.samples()))
    np.testing.assert_allclose(rows.mean(axis=0), 0, atol=1e-12)
    np.testing.assert_allclose(rows.std(axis=0, ddof=1), 1, rtol=1e-10)


def test_a_column_that_does_not_vary_stays_finite() -> None:
    normalizer = Normalizer(2)
    normalizer.set(np.array([1.0, 2.0]), np.array([0.0, 4.0]))
    assert normalizer.standardise(np.array([[1.0, 6.0]])).tolist() == [[0.0, 1.0]]


def test_only_the_published_way_looks_at_samples_held_out(
    store: Store, split: Split
) -> None:
    def fitted(normaliser: str, samples: np.ndarray) -> np.ndarray:
        model = PhysGNNModel(store.body, width=8, normaliser=normaliser)
        model.fit(store, samples)
        return model.normalizer.std.numpy()

    honest = fitted("training", split.train)
    np.testing.assert_array_equal(honest, force_statistics(store, split.train)[1])
    as_published = fitted("published", split.train)
    assert (as_published != honest).all()
    np.testing.assert_array_equal(as_published, fitted("training", store.samples()))


@pytest.mark.parametrize("dataset", [1, 2])
def test_statistics_of_the_published_datasets(
    shared: Path, tmp_path: Path, dataset: int
) -> None:
    golden = np.load(shared / "paper" / "golden_forward.npz")
    mesh = TetMesh(golden["points"], golden["cells"], golden["region"])
    preset = PRESETS[f"paper-{dataset}"]
    mesh, paths = preset.on(mesh)
    store = Store.create(
        tmp_path / "loads.zarr",
        Body(mesh, preset.materials, mesh.point_set("fixed")),
        paths,
        provenance={},
    )
    samples = np.argwhere(np.ones((store.n_paths, store.n_levels)))
    mean, std = force_statistics(store, samples)
    np.testing.assert_allclose(mean, golden[f"feature_mean_{dataset}"], rtol=1e-6)
    np.testing.assert_allclose(std, golden[f"feature_std_{dataset}"], rtol=1e-6)

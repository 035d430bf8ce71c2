"""Pooled and per-sample errors against everything computed at once."""

from pathlib import Path

import numpy as np
import pytest

from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.evaluation.evaluate import evaluate
from physgnn.evaluation.metrics import points_near, points_of_region
from physgnn.evaluation.result import Report
from physgnn.learning.interface import Body
from physgnn.mechanics.loads import LoadCase
from physgnn.prediction.predictor import Predictor


def swaying(store: Store) -> Predictor:
    """A wrong predictor whose error depends on load and node."""
    points = store.mesh.points

    def answer(case: LoadCase) -> np.ndarray:
        return points * case.forces.sum() * 10

    return Predictor(Body.of(store), answer)


@pytest.fixture(scope="module")
def report(store: Store) -> Report:
    samples = store.samples()[::-2]  # latest first, every other level
    return evaluate({"swaying": swaying(store)}, store, samples, split="some")


def test_against_brute_force(store: Store, report: Report) -> None:
    samples = sorted(map(tuple, store.samples()[::-2].tolist()))
    truth = np.stack([store.displacement(p)[k] for p, k in samples]).astype(float)
    predict = swaying(store)
    answers = [predict(store.load_case(p, k)).displacement for p, k in samples]
    error = np.linalg.norm(truth - np.stack(answers), axis=2)
    size = np.linalg.norm(truth, axis=2)
    model = report.model("swaying")
    assert model.euclidean.mean == pytest.approx(error.mean())
    assert model.euclidean.std == pytest.approx(error.std())
    assert model.euclidean.largest == pytest.approx(error.max())
    assert model.euclidean.within_1mm == np.mean(error <= 1)
    component = np.abs(truth - np.stack(answers)).mean(axis=(0, 1))
    means = [model.by_component[name].mean for name in "xyz"]
    np.testing.assert_allclose(means, component)
    summary = model.summary
    assert summary.n_samples == len(samples)
    assert summary.largest_displacement == pytest.approx(size.max())
    assert summary.largest_displacement_std == pytest.approx(size.max(axis=1).std())
    assert summary.largest_error_mean == pytest.approx(error.max(axis=1).mean())
    assert summary.largest_error_std == pytest.approx(error.max(axis=1).std())
    assert summary.relative_pooled == pytest.approx(error.mean() / size.mean())
    relative = np.sqrt((error**2).sum(axis=1) / (size**2).sum(axis=1))
    assert summary.relative_mean == pytest.approx(relative.mean())
    assert [(s.path, s.level) for s in model.samples] == samples
    worst = samples[int(error.max(axis=1).argmax())]
    assert (model.worst.path, model.worst.level) == worst
    near = points_near(store.mesh, store.load_path(0).nodes)
    tumour = points_of_region(store.mesh, 1)
    assert model.by_region["loaded_region"].mean == pytest.approx(error[:, near].mean())
    assert model.by_region["tumour"].mean == pytest.approx(error[:, tumour].mean())
    levels = np.array([level for _, level in samples])
    for level, distribution in enumerate(model.by_level):
        if level % 2 == 0:
            assert distribution is None
        else:
            assert distribution is not None
            assert distribution.mean == pytest.approx(error[levels == level].mean())


def test_the_truth_has_no_error(store: Store) -> None:
    def truth(case: LoadCase) -> np.ndarray:
        full = store.load_path(2).forces
        factor = np.linalg.norm(case.forces) / np.linalg.norm(full)
        level = round(factor * store.n_levels) - 1
        return store.displacement(2)[level].astype(float)

    samples = np.array([[2, level] for level in range(store.n_levels)])
    predictors = {"truth": Predictor(Body.of(store), truth)}
    model = evaluate(predictors, store, samples).model("truth")
    assert model.euclidean.largest == 0
    assert model.euclidean.percentile_99 == 0
    assert model.euclidean.within_1mm == 1
    assert model.summary.relative_mean == 0


def test_progress_counts_samples(store: Store) -> None:
    calls: list[tuple[int, int]] = []
    evaluate(
        {"swaying": swaying(store)},
        store,
        store.samples()[:4],
        progress=lambda done, total, _: calls.append((done, total)),
    )
    assert calls == [(1, 4), (2, 4), (3, 4), (4, 4)]


def test_no_samples_is_an_input_error(store: Store) -> None:
    with pytest.raises(InputError, match="no samples to evaluate"):
        evaluate({}, store, np.empty((0, 2), dtype=np.int64), split="path")


def test_json_round_trip(report: Report, tmp_path: Path) -> None:
    written = report.with_facts(case={"preset": "demo"}, solver_seconds=1.5)
    written.write(tmp_path / "metrics.json")
    assert Report.read(tmp_path / "metrics.json") == written


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"format": "other"}'])
def test_another_file_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "metrics.json").write_text(text)
    with pytest.raises(InputError, match=r"metrics\.json"):
        Report.read(tmp_path / "metrics.json")


def test_unknown_model_names_those_there_are(report: Report) -> None:
    with pytest.raises(InputError, match="it has: swaying"):
        report.model("lifted")

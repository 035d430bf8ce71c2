"""Pooled and per-sample errors against everything computed at once."""

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from physgnn.arrays import FloatArray
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.evaluation.measure.held_out import NONE, HeldOut
from physgnn.evaluation.measure.measuring import evaluate, measure
from physgnn.evaluation.measure.metrics import points_near, points_of_region
from physgnn.evaluation.measure.result import Report
from physgnn.evaluation.measure.rows import Row
from physgnn.learning.surrogate import FromFunction
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.prediction import Prediction
from physgnn.prediction.predictor import Predictor

Displacement = Callable[[LoadCase], FloatArray]


def rows(store: Store, **answers: Displacement) -> list[Row]:
    body = store.body
    return [
        Row(name, make=lambda answer=answer: Predictor(FromFunction(body, answer)))
        for name, answer in answers.items()
    ]


def swaying(store: Store) -> Displacement:
    """A wrong predictor whose error depends on load and node."""
    points = store.mesh.points

    def answer(case: LoadCase) -> np.ndarray:
        return points * case.forces.sum() * 10

    return answer


@pytest.fixture(scope="module")
def report(store: Store) -> Report:
    samples = store.samples()[::-2]  # latest first, every other level
    held_out = HeldOut(store, "some", NONE, samples)
    return evaluate(rows(store, swaying=swaying(store)), held_out)


def test_against_brute_force(store: Store, report: Report) -> None:
    samples = sorted(map(tuple, store.samples()[::-2].tolist()))
    truth = np.stack([store.displacement(p)[k] for p, k in samples]).astype(float)
    predict = swaying(store)
    answers = [predict(store.load_case(p, k)) for p, k in samples]
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
    held_out = HeldOut(store, "some", NONE, samples)
    model = evaluate(rows(store, truth=truth), held_out).model("truth")
    assert model.euclidean.largest == 0
    assert model.euclidean.percentile_99 == 0
    assert model.euclidean.within_1mm == 1
    assert model.summary.relative_mean == 0


def test_progress_counts_samples_of_all_rows(store: Store) -> None:
    calls: list[tuple[int, int, str]] = []
    evaluate(
        rows(store, one=swaying(store), two=swaying(store)),
        HeldOut(store, "some", NONE, store.samples()[:2]),
        progress=lambda *call: calls.append(call),
    )
    assert calls == [(1, 4, "one"), (2, 4, "one"), (3, 4, "two"), (4, 4, "two")]


def test_predictors_are_made_one_after_another(store: Store) -> None:
    alive: list[str] = []

    class Watched:
        def __init__(self, name: str) -> None:
            assert alive == []
            alive.append(name)
            self.answer = Predictor(FromFunction(store.body, swaying(store)))

        def __call__(self, case: LoadCase, **_: object) -> Prediction:
            return self.answer(case)

        def __del__(self) -> None:
            alive.clear()

    two = [Row(name, make=lambda name=name: Watched(name)) for name in "ab"]
    evaluate(two, HeldOut(store, "some", NONE, store.samples()[:1]))


def test_training_time_is_what_making_takes_unless_it_is_known(store: Store) -> None:
    held_out = HeldOut(store, "some", NONE, store.samples()[:1])

    def busy() -> Predictor:
        end = time.process_time() + 0.3
        while time.process_time() < end:
            pass
        return Predictor(FromFunction(store.body, swaying(store)))

    measured = measure(Row("busy", busy, seed=2), held_out)
    assert measured.minutes is not None
    assert measured.minutes * 60 == pytest.approx(0.3, abs=0.2)
    assert measured.seed == 2
    assert measure(Row("busy", busy, minutes=44.0), held_out).minutes == 44.0


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

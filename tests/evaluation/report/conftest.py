"""A report of the quick baselines."""

import pytest

from physgnn.dataset.storage.store import Store
from physgnn.evaluation.measure.baselines import QUICK, baseline_rows
from physgnn.evaluation.measure.held_out import HeldOut
from physgnn.evaluation.measure.measuring import evaluate
from physgnn.evaluation.measure.result import Report


@pytest.fixture(scope="module")
def report(store: Store) -> Report:
    samples = store.samples()
    held_out = HeldOut(store, "path", samples, samples)
    return evaluate(baseline_rows(QUICK, held_out), held_out)

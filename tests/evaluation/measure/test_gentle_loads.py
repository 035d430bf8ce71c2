"""Which loads are as gentle as those of surgery, and the errors there."""

import json

import numpy as np
import pytest

from physgnn.dataset.storage.store import Store
from physgnn.evaluation.measure import gentle_loads
from physgnn.evaluation.measure.baselines import QUICK, baseline_rows
from physgnn.evaluation.measure.gentle_loads import (
    GentleLoads,
    find_gentle_loads,
    mean_over,
)
from physgnn.evaluation.measure.held_out import HeldOut
from physgnn.evaluation.measure.measuring import evaluate


def test_loads_count_by_the_sum_of_their_forces(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    force = {
        (path, level): np.linalg.norm(store.load_case(path, level).forces, axis=1).sum()
        for path, level in store.samples().tolist()
    }
    limit = float(np.median([*force.values()]))
    monkeypatch.setattr(gentle_loads, "GENTLE_N", limit)
    found = find_gentle_loads(store, store.samples())
    assert found.samples == {key for key, value in force.items() if value <= limit}
    assert found.n_samples == len(force)
    assert found.gentlest_n == pytest.approx(min(force.values()))
    assert GentleLoads.from_json(json.loads(json.dumps(found.to_json()))) == found


def test_a_mean_is_over_the_gentle_samples_alone(store: Store) -> None:
    samples = store.samples()
    held_out = HeldOut(store, "path", samples, samples)
    linear = evaluate(baseline_rows(QUICK, held_out), held_out).model("linear")
    first = linear.samples[0]
    loads = GentleLoads(frozenset({(first.path, first.level)}), len(samples), 0.1)
    assert mean_over(loads, "mean")(linear) == first.mean
    nothing = GentleLoads(frozenset(), len(samples), 0.4)
    assert mean_over(nothing, "mean")(linear) is None

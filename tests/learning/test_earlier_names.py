"""Methods and options by the names they had before: old records and files still do."""

import json
from pathlib import Path

import pytest

from physgnn.bundled import BUNDLED_RUN
from physgnn.config.training import read_training
from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.models import (
    EARLIER_NAMES,
    EARLIER_OPTIONS,
    MODELS,
    build_model,
    method_options,
    model_class,
    recorded_options,
    resolved_options,
)
from physgnn.learning.runs.checkpoint import Checkpoint, read_record
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train

EARLIER = {
    "anchors": 2, "reach": 2, "width": 8, "layers": 1, "modes": 2, "settle": 3,
}  # fmt: skip
# none had response modes, learnt along any axes or had a third term then
PRESENT = {
    "anchors": 2, "k_hops": 2, "width": 8, "layers": 1, "response_modes": 0,
    "pod_modes": 2, "submodel_hops": 3, "any_axes": False, "exponential": False,
    "imbalance": False, "relaxed_patches": 0,
}  # fmt: skip


@pytest.mark.parametrize("earlier", EARLIER_NAMES)
def test_a_method_by_its_earlier_name_is_the_same(earlier: str) -> None:
    assert model_class(earlier) is model_class(EARLIER_NAMES[earlier])
    assert EARLIER_NAMES[earlier] in MODELS


def test_each_earlier_option_is_one_of_a_method_now() -> None:
    present = {name for method in MODELS for name in resolved_options(method, {})}
    assert set(EARLIER_OPTIONS.values()) <= present
    assert not set(EARLIER_OPTIONS) & present


def test_options_by_earlier_names_make_the_same(store: Store) -> None:
    assert resolved_options("lifted", recorded_options("lifted", EARLIER)) == PRESENT
    made = build_model("reduced", store.body, together=2, reach=0, reach_from_rest=1)
    named = (made.nearest_anchors, made.k_hops, made.k_hops_from_rest)
    assert named == (2, 0, 1)


def test_an_option_by_both_names_is_refused(store: Store) -> None:
    with pytest.raises(InputError, match=r"'k_hops'.*given twice"):
        build_model("lifted", store.body, reach=2, k_hops=3)


def test_the_options_of_a_strangers_method_are_its_own() -> None:
    assert method_options("theirs:Method", {"reach": 1}) == {"reach": 1}


def test_a_file_of_settings_may_have_them(tmp_path: Path) -> None:
    file = tmp_path / "train.toml"
    file.write_text('model = "lifted"\n[options]\nreach = 2\nmodes = 0\n')
    config = read_training(file)
    assert config.options == {"k_hops": 2, "pod_modes": 0}
    assert TrainingConfig(model="nodal_network").model == "mlp"


def test_a_run_of_earlier_names_opens_and_goes_on(
    store: Store, split: Split, tmp_path: Path
) -> None:
    run = tmp_path / "run"
    config = TrainingConfig(model="lifted", options=PRESENT, max_epochs=1, seed=1)
    train(store, split, config, run)
    file = RunFolder(run).record
    record = json.loads(file.read_text())
    record["config"]["options"] = EARLIER
    record.pop("manifest")  # it had none then
    RunFolder(run).manifest.unlink()
    file.write_text(json.dumps(record))
    assert read_record(run)["config"]["options"] == PRESENT
    Checkpoint.load(run)
    later = ("exponential", "imbalance")
    options = {**EARLIER, "response_modes": 0, **dict.fromkeys(later, False)}
    options["relaxed_patches"] = 0
    longer = TrainingConfig(model="lifted", options=options, max_epochs=2, seed=1)
    train(store, split, longer, run, resume=True)


def test_the_bundled_run_has_the_names_of_today() -> None:
    written = json.loads(RunFolder(BUNDLED_RUN).record.read_text("utf-8"))
    options = written["config"]["options"]
    assert options == Checkpoint.load(BUNDLED_RUN).record["config"]["options"]
    assert set(options) == set(resolved_options("lifted", {}))

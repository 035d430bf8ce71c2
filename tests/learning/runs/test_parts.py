"""The files of a run, with their digests: what was changed or exchanged is named."""

import json
import logging
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.io import read_mesh, write_mesh
from physgnn.io.integrity.digest import Manifest, digest_of_file
from physgnn.learning.models import build_model
from physgnn.learning.runs import parts
from physgnn.learning.runs.checkpoint import Checkpoint, read_record
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.parts import write_part, write_parts
from physgnn.prediction.error_bounds.run_calibration import calibrate_run
from physgnn.prediction.predictor import Predictor

OPTIONS = {"pod_modes": 2}


@pytest.fixture
def run(store: Store, split: Split, tmp_path: Path) -> Path:
    return trained(store, split, tmp_path / "run", 0)


def trained(store: Store, split: Split, run: Path, seed: int) -> Path:
    """A calibrated run, quickly."""
    model = build_model("pod-network", store.body, **OPTIONS, epochs=2, width=4)
    model.fit(store, split.train, seed)
    config = {
        "model": "pod-network", "seed": seed,
        "options": {**OPTIONS, "epochs": 2, "width": 4},
    }  # fmt: skip
    Checkpoint(model, {"config": config}).save(run)
    calibrate_run(run, store, split)
    return run


def doubled_stiffness(run: Path, _: Path) -> str:
    file = RunFolder(run).record
    record = json.loads(file.read_text())
    record["materials"]["0"]["youngs_modulus_pa"] *= 2
    file.write_text(json.dumps(record))
    return "run.json"


def other_element(run: Path, _: Path) -> str:
    file = RunFolder(run).record
    file.write_text(file.read_text().replace('"tet4"', '"tet4-averaged"'))
    return "run.json"


def altered_weights(run: Path, _: Path) -> str:
    file = RunFolder(run).weights
    arrays = load_file(file)
    name = min(arrays)
    arrays[name] = arrays[name] + np.ones_like(arrays[name])
    save_file(arrays, file)
    return "weights.safetensors"


def other_weights(run: Path, other: Path) -> str:
    shutil.copy(RunFolder(other).weights, RunFolder(run).weights)
    return "weights.safetensors"


def fewer_fixed_points(run: Path, _: Path) -> str:
    file = RunFolder(run).case
    mesh = read_mesh(file)
    write_mesh(file, mesh.with_point_sets(fixed=mesh.point_set("fixed")[1:]))
    return "case.vtu"


def other_quick_bounds(run: Path, other: Path) -> str:
    shutil.copy(RunFolder(other).calibration, RunFolder(run).calibration)
    return "calibration.json"


def other_sharp_bounds(run: Path, other: Path) -> str:
    shutil.copy(RunFolder(other).relaxation, RunFolder(run).relaxation)
    return "calibration-relaxation.json"


def narrower_bounds(run: Path, _: Path) -> str:
    file = RunFolder(run).calibration
    record = json.loads(file.read_text())
    file.write_text(json.dumps({**record, "max_factor": record["max_factor"] / 2}))
    return "calibration.json"


def lost_manifest(run: Path, _: Path) -> str:
    RunFolder(run).manifest.unlink()
    return "manifest.json"


def edited_manifest(run: Path, other: Path) -> str:
    altered_weights(run, other)
    file = RunFolder(run).manifest
    manifest = json.loads(file.read_text())
    manifest["parts"]["weights.safetensors"] = [digest_of_file(RunFolder(run).weights)]
    file.write_text(json.dumps(manifest))
    return "manifest.json"


@pytest.mark.parametrize(
    "change",
    [
        doubled_stiffness, other_element, altered_weights, other_weights,
        fewer_fixed_points, other_quick_bounds, other_sharp_bounds, narrower_bounds,
        lost_manifest, edited_manifest,
    ],
)  # fmt: skip
def test_what_was_changed_is_named_with_the_remedy(
    run: Path,
    store: Store,
    split: Split,
    tmp_path: Path,
    change: Callable[[Path, Path], str],
) -> None:
    Predictor.load(run, warm=False)
    other = trained(store, split, tmp_path / "other", 1)
    name = change(run, other)
    with pytest.raises(InputError, match=name) as raised:
        Predictor.load(run, warm=False)
    assert "\n" not in str(raised.value)
    assert "train it again" in str(raised.value)


def test_a_run_of_before_opens_with_a_note(
    run: Path, caplog: pytest.LogCaptureFixture
) -> None:
    files = RunFolder(run)
    files.manifest.unlink()
    record = json.loads(files.record.read_text())
    record.pop("manifest")
    files.record.write_text(json.dumps(record))
    with caplog.at_level(logging.WARNING):
        Predictor.load(run, warm=False)
        Predictor.load(run, warm=False)
    assert caplog.text.count("has no digest: it was made before 0.2") == 1
    write_part(files.calibration, files.calibration.read_text())
    assert not files.manifest.exists()  # for nobody can vouch for the other files


def test_bounds_of_other_weights_do_not_stay(
    run: Path, store: Store, split: Split
) -> None:
    checkpoint = Checkpoint.load(run)
    checkpoint.save(run)
    assert all(file.is_file() for file in RunFolder(run).calibrations)
    checkpoint.model.fit(store, split.train, 5)
    checkpoint.save(run)
    assert not any(file.exists() for file in RunFolder(run).calibrations)
    Predictor.load(run, warm=False)


class KilledError(BaseException):
    """Stands for the end of the process."""


@pytest.mark.parametrize("survived", range(7))
def test_a_kill_after_any_write_leaves_a_run_that_opens(
    run: Path,
    store: Store,
    split: Split,
    monkeypatch: pytest.MonkeyPatch,
    survived: int,
) -> None:
    """New weights: manifest, weights, record, two calibrations away, manifest."""
    checkpoint = Checkpoint.load(run)
    before = RunFolder(run).weights.read_bytes()
    checkpoint.model.fit(store, split.train, 5)
    count = 0

    def stopping(name: str) -> None:
        original = getattr(Path, name)

        def stopped(path: Path, *args: object, **options: object) -> object:
            nonlocal count
            if name == "unlink" and path.name.startswith("."):
                return original(path, *args, **options)
            if count == survived:
                raise KilledError
            count += 1
            return original(path, *args, **options)

        monkeypatch.setattr(Path, name, stopped)

    stopping("replace")
    stopping("unlink")
    try:
        checkpoint.save(run)
        assert survived == 6
    except KilledError:
        pass
    monkeypatch.undo()
    assert Predictor.load(run, warm=False)
    assert (RunFolder(run).weights.read_bytes() == before) == (survived < 2)
    checkpoint.save(run)
    listed = Manifest.read(RunFolder(run).manifest, "").parts
    assert all(len(digests) == 1 for digests in listed.values())
    assert read_record(run)["config"]["seed"] == 0


def test_parts_take_their_places_in_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    order = []
    original = Path.replace

    def noted(path: Path, target: Path) -> Path:
        order.append(Path(target).name)
        return original(path, target)

    monkeypatch.setattr(Path, "replace", noted)
    names = ("one", "two", "three")
    write_parts(
        tmp_path, {tmp_path / n: lambda part, n=n: part.write_text(n) for n in names}
    )
    assert order == ["manifest.json", *names, "manifest.json"]
    assert set(parts.read_manifest(tmp_path).parts) == set(names)

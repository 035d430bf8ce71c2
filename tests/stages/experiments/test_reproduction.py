"""The published protocol and the ablation, small: whole, and the same when repeated."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from physgnn.dataset import PRESETS, Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_mesh
from physgnn.learning.physgnn.architecture import Architecture
from physgnn.learning.runs.folder import RunFolder
from physgnn.mechanics.loads.sampling import cone_paths
from physgnn.stages.datasets.simulation import simulate_mesh
from physgnn.stages.experiments import reproduction
from physgnn.stages.experiments.ablation import Ablation, run_ablation
from physgnn.stages.experiments.ablation_panels import Trial, named_panels
from physgnn.stages.experiments.pipeline import can_resume
from physgnn.stages.experiments.reproduction import Reproduction, reproduce


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """The bundled case's loads, few and on any mesh with the point sets."""
    paths = partial(
        cone_paths,
        total_force_n=0.02,
        n_levels=2,
        n_paths=10,
        cone_deg=20.0,
        nodes_per_path=3,
    )
    preset = replace(PRESETS["demo"], paths=paths, fixed=None, loaded=None)
    monkeypatch.setitem(PRESETS, "demo", preset)  # type: ignore[arg-type]
    monkeypatch.setattr("os.cpu_count", lambda: 1)  # no processes to start


@pytest.mark.slow
@pytest.mark.usefixtures("small")
def test_reproduce(
    block: TetMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(reproduction.BEST, 2, (3, 4))
    write_mesh(tmp_path / "case.vtu", block)
    hours = 2 / 3600
    text = reproduce(tmp_path, budget_hours=hours)
    for split in ("published", "path"):
        assert f"## Split '{split}'" in text
        record = json.loads((tmp_path / f"run-{split}" / "run.json").read_text())
        assert record["config"]["options"]["normaliser"] == "published"
        assert record["split"]["name"] == split
    assert "published: 1.83 s on a 2-core Xeon" in text

    said: list[str] = []
    assert reproduce(tmp_path, budget_hours=hours, log=said.append) == text
    assert sum("there already" in line for line in said) == 6

    reproduce(tmp_path, budget_hours=2 * hours)
    run = RunFolder(tmp_path / "run-path")
    record = json.loads(run.record.read_text())
    assert record["config"]["max_minutes"] == pytest.approx(60 * hours)


@pytest.mark.slow
@pytest.mark.usefixtures("small")
def test_ablate(block: TetMesh, tmp_path: Path) -> None:
    store, _ = simulate_mesh(block, "demo", tmp_path / "loads.zarr")
    budget = Ablation(1, 4, 1, width=4, precision="bfloat16")
    out = tmp_path / "out"
    told: list[int] = []
    text = run_ablation(
        {2: store.path}, budget, out, progress=lambda done, *_: told.append(done)
    )
    assert told == list(
        range(1, 17)
    )  # twelve configurations, three depths, one without
    rows = [line for line in text.splitlines() if line.startswith("| 2 |")]
    assert len(rows) == 7 + 6 + 4 + 2
    of_configuration_3 = {rows[i].split("|")[3] for i in (2, 9, 15, 18)}
    assert len(of_configuration_3) == 1  # it is in all four panels
    assert (out / "ablation.png").is_file()
    before = (out / "ablation.json").stat().st_mtime_ns
    assert run_ablation({2: store.path}, budget, out) == text
    assert (out / "ablation.json").stat().st_mtime_ns == before
    with pytest.raises(InputError, match="another budget"):
        run_ablation({2: store.path}, replace(budget, epochs=2), out)
    old = json.loads((out / "ablation.json").read_text())
    losses = {f"(2, {c}, 0)": Trial(Architecture(c, 2), 0).name for c in range(1, 13)}
    old["losses"] = {old_name: old["losses"][n] for old_name, n in losses.items()}
    (out / "ablation.json").write_text(json.dumps(old))  # as release 0.1 wrote it
    panels = named_panels("aggregation, layer-type")
    assert run_ablation({2: store.path}, budget, out, panels=panels) in text
    with pytest.raises(InputError, match="panel must be all or one of"):
        named_panels("width")


@pytest.mark.usefixtures("small")
def test_a_part_of_the_samples_keeps_the_parts_apart(
    block: TetMesh, tmp_path: Path
) -> None:
    store: Store = simulate_mesh(block, "demo", tmp_path / "loads.zarr")[0]
    part = Ablation(samples=6).part_of(store)
    assert (len(part.train), len(part.validation)) == (6, 2)


@pytest.mark.parametrize("wrong", [{"dataset": 3}, {"budget_hours": 0.0}])
def test_refuses_what_makes_no_sense(wrong: dict[str, float]) -> None:
    with pytest.raises(InputError, match=next(iter(wrong))):
        Reproduction(**{"dataset": 2, "budget_hours": 1.0, **wrong})


def test_what_ended_within_its_first_epoch_starts_again(tmp_path: Path) -> None:
    run = tmp_path / "run"
    assert not can_resume(RunFolder(run))
    run.mkdir()
    (run / "run.json").write_text("{}")
    assert not can_resume(RunFolder(run))
    assert not run.exists()
    run.mkdir()
    (run / "last.ckpt").touch()
    assert can_resume(RunFolder(run))
    assert run.exists()

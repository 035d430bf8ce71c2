"""The demonstration, small: it comes to a report, and a second run changes nothing."""

import shutil
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import pytest

from physgnn.dataset import PRESETS
from physgnn.stages.experiments import bundling, demonstration


def times(folder: Path) -> dict[Path, int]:
    return {f: f.stat().st_mtime_ns for f in folder.rglob("*") if f.is_file()}


@dataclass(frozen=True)
class Made:
    """The demonstration, small: where it is, its summary, and what was said."""

    folder: Path
    summary: str
    said: list[str]


@pytest.fixture(scope="module")
def few_loads() -> Iterator[pytest.MonkeyPatch]:
    preset = PRESETS["demo"]
    few = replace(preset, paths=partial(preset.paths, n_paths=10, n_levels=2))
    small = replace(demonstration.DEMO, target_points=2800, training_minutes=0.05)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(PRESETS, "demo", few)  # type: ignore[arg-type]
        patch.setattr("os.cpu_count", lambda: 1)  # no processes to start
        patch.setattr(demonstration, "DEMO", small)
        yield patch


@pytest.fixture(scope="module")
def made(
    few_loads: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> Made:
    del few_loads
    folder, said = tmp_path_factory.mktemp("made") / "demo", list[str]()
    return Made(folder, demonstration.demo(folder, log=said.append), said)


@pytest.mark.slow
def test_the_bundled_models_card_compares_it_with_peers(
    made: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    small = replace(bundling.BUNDLED, target_points=2800, training_minutes=0.05)
    monkeypatch.setattr(bundling, "BUNDLED", replace(small, baselines="pod-network"))
    out, work = tmp_path / "bundled", tmp_path / "work"
    work.mkdir()  # with the demonstration's mesh and solutions, which are the same
    shutil.copy(made.folder / "case.vtu", work)
    shutil.copytree(made.folder / "loads.zarr", work / "loads.zarr")
    bundling.bundle(work, out, log=print)
    card = (out / "model_card.md").read_text("utf-8")
    for row in ("POD + small network", "PhysGNN", "Lifted network", "Repaired"):
        assert f"| {row}" in card
    assert str(tmp_path) not in card
    assert str(made.folder) not in card


@pytest.mark.slow
def test_demo(made: Made) -> None:
    assert "report.html" in made.summary
    assert "mean error on load paths never trained on" in made.summary
    assert not any("there already" in line for line in made.said)
    names = {path.name for path in made.folder.iterdir()}
    assert names == {
        "case.vtu",
        "loads.zarr",
        "run",
        "report.html",
        "load.json",
        "prediction.vtu",
    }
    page = (made.folder / "report.html").read_text("utf-8")
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert "https://" not in page

    before, said = times(made.folder), list[str]()
    again = demonstration.demo(made.folder, log=said.append)
    assert again == made.summary
    assert times(made.folder) == before
    assert sum("there already" in line for line in said) == 5

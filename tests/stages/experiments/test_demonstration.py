"""The demonstration, small: it comes to a report, and a second run changes nothing."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from physgnn.dataset import PRESETS
from physgnn.stages.experiments import bundling, demonstration


def times(folder: Path) -> dict[Path, int]:
    return {f: f.stat().st_mtime_ns for f in folder.rglob("*") if f.is_file()}


@pytest.fixture
def few_loads(monkeypatch: pytest.MonkeyPatch) -> None:
    preset = PRESETS["demo"]
    few = replace(preset, paths=partial(preset.paths, n_paths=10, n_levels=2))
    monkeypatch.setitem(PRESETS, "demo", few)  # type: ignore[arg-type]
    monkeypatch.setattr("os.cpu_count", lambda: 1)  # no processes to start


@pytest.mark.slow
@pytest.mark.usefixtures("few_loads")
def test_the_bundled_models_card_compares_it_with_peers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    small = replace(bundling.BUNDLED, target_points=2800, training_minutes=0.05)
    monkeypatch.setattr(bundling, "BUNDLED", replace(small, baselines="pod-network"))
    out = tmp_path / "bundled"
    bundling.bundle(tmp_path / "work", out, log=print)
    card = (out / "model_card.md").read_text("utf-8")
    for row in ("POD + small network", "PhysGNN", "Lifted network", "Repaired"):
        assert f"| {row}" in card
    assert str(tmp_path) not in card


@pytest.mark.slow
@pytest.mark.usefixtures("few_loads")
def test_demo(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    small = replace(demonstration.DEMO, target_points=2800, training_minutes=0.05)
    monkeypatch.setattr(demonstration, "DEMO", small)

    said: list[str] = []
    summary = demonstration.demo(tmp_path / "demo", log=said.append)
    assert "report.html" in summary
    assert "mean error on load paths never trained on" in summary
    assert not any("there already" in line for line in said)
    names = {path.name for path in (tmp_path / "demo").iterdir()}
    assert names == {
        "case.vtu",
        "loads.zarr",
        "run",
        "report.html",
        "load.json",
        "prediction.vtu",
    }
    page = (tmp_path / "demo" / "report.html").read_text("utf-8")
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert "https://" not in page

    before = times(tmp_path)
    again = demonstration.demo(tmp_path / "demo", log=said.append)
    assert again == summary
    assert times(tmp_path) == before
    assert sum("there already" in line for line in said) == 5

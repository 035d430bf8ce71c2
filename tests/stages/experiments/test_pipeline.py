"""What is whole stays, what is not goes on, and more time trains on."""

import json
from pathlib import Path
from typing import Any

import pytest

from physgnn.geometry import Surface
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.training.config import TrainingConfig
from physgnn.stages.experiments import pipeline as steps
from physgnn.stages.experiments.pipeline import Pipeline


class Trainer:
    """Stands in for training: leaves what it would, or is interrupted."""

    def __init__(self) -> None:
        self.resumed: list[bool] = []
        self.interrupted = False

    def __call__(
        self,
        _: Path,
        split: str,
        config: TrainingConfig,
        run: Path,
        *,
        resume: bool,
        **how: Any,
    ) -> None:
        assert split == "path" and "progress" in how
        self.resumed.append(resume)
        files = RunFolder(run)
        run.mkdir(exist_ok=True)
        files.state.touch()
        files.record.write_text(
            json.dumps({"config": {"max_minutes": config.max_minutes}})
        )
        if self.interrupted:
            raise KeyboardInterrupt
        for file in files.calibrations:
            file.touch()


@pytest.fixture
def trainer(monkeypatch: pytest.MonkeyPatch) -> Trainer:
    made = Trainer()
    monkeypatch.setattr(steps, "train_run", made)
    return made


def config(minutes: float) -> TrainingConfig:
    return TrainingConfig(max_minutes=minutes)


def test_training_is_done_once_and_goes_on(tmp_path: Path, trainer: Trainer) -> None:
    said: list[str] = []
    pipeline = Pipeline(tmp_path, "test", log=said.append)
    trainer.interrupted = True
    with pytest.raises(KeyboardInterrupt):
        pipeline.train("run", "path", config(1.0))
    assert not pipeline.run("run").path.exists()
    trainer.interrupted = False
    run = pipeline.train("run", "path", config(1.0))
    assert trainer.resumed == [False, True]
    assert {path.name for path in tmp_path.iterdir()} == {"run"}

    for minutes in (1.0, 0.5):
        pipeline.train("run", "path", config(minutes))
    assert len(said) == 2 and "there already" in said[0]
    assert len(trainer.resumed) == 2

    report = run.evaluation("path").report
    report.parent.mkdir()
    report.touch()
    pipeline.train("run", "path", config(2.0))
    assert trainer.resumed == [False, True, True]
    assert not report.exists()  # it was of the earlier weights


def test_what_an_earlier_version_left_half_done_goes_on(
    tmp_path: Path, trainer: Trainer
) -> None:
    """It trained in place: a run without error bounds was interrupted."""
    run = RunFolder(tmp_path / "run")
    run.path.mkdir()
    run.state.touch()
    run.record.write_text(json.dumps({"config": {"max_minutes": 1.0}}))
    Pipeline(tmp_path, "test").train("run", "path", config(1.0))
    assert trainer.resumed == [True]


def test_a_mesh_that_is_there_stays(tmp_path: Path) -> None:
    def never() -> list[Surface]:
        raise AssertionError

    (tmp_path / "case.vtu").touch()
    Pipeline(tmp_path, "test").mesh(never)

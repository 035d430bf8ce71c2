"""The bundled run has the files that a run folder says it has, under these names."""

from pathlib import Path

from physgnn.bundled import BUNDLED_RUN
from physgnn.learning.runs.folder import EvaluationFolder, RunFolder


def test_the_bundled_run() -> None:
    run = RunFolder(BUNDLED_RUN)
    for file in (run.record, run.weights, run.case, run.model_card, *run.calibrations):
        assert file.is_file()
    assert not run.state.exists()


def test_names_are_those_of_runs_written_before() -> None:
    run = RunFolder("run")  # type: ignore[arg-type]
    assert run.state == Path("run/last.ckpt")
    assert run.evaluation("path") == EvaluationFolder(Path("run/evaluation-path"))
    assert run.evaluation("path").metrics == Path("run/evaluation-path/metrics.json")
    assert run.evaluation("path").report == Path("run/evaluation-path/report.html")

"""A method from outside the package, by the command line (docs/howto/add_method.md)."""

import re
import shutil
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from physgnn.dataset.storage.store import Store
from physgnn.evaluation.measure.result import Report
from physgnn.io.load_case import write_load_case
from physgnn.prediction.predictor import Predictor
from warm_python import WarmPython

TEMPLATE = Path(__file__).parents[2] / "docs" / "templates" / "method.py"
METHOD = "method:NearestLoad"
COMMAND = "from physgnn.cli import main; main()"


def physgnn(warm: WarmPython, folder: Path, *arguments: str, code: int = 0) -> str:
    """Run a command in a folder, as a user does."""
    made = warm.run(COMMAND, *arguments, folder=folder)
    assert made.returncode == code, made.stderr
    return made.stdout


def test_the_template_is_about_thirty_lines() -> None:
    text = TEMPLATE.read_text("utf-8")
    code = re.sub(r'^""".*?"""', "", text, flags=re.S)
    assert len([line for line in code.splitlines() if line.strip()]) <= 32


@pytest.mark.slow
def test_it_is_trained_saved_loaded_and_evaluated(
    warm: WarmPython, store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copyfile(TEMPLATE, tmp_path / "method.py")
    here = partial(physgnn, warm, tmp_path)
    here("train", str(store.path), "--model", METHOD, "-o", "run")
    table = here("evaluate", "run", "--baselines", "zero,linear")
    assert "nearestload" in table.lower()
    here("train", str(store.path), "--model", "zero", "-o", "other")
    here("evaluate", "other", "--baselines", METHOD)
    ours, beside = (
        Report.read(tmp_path / run / "evaluation-path" / "metrics.json").model(METHOD)
        for run in ("run", "other")
    )
    assert ours.euclidean.mean == pytest.approx(beside.euclidean.mean)
    case = store.load_case(0, 1)
    write_load_case(tmp_path / "load.json", case)
    # the displacement of another load is no good one, and is written with its reasons
    predict = ("predict", "run", "--load", "load.json", "-o", "displacement.vtu")
    here(*predict, code=3)
    assert (tmp_path / "displacement.vtu").is_file()
    monkeypatch.syspath_prepend(tmp_path)
    predictor = Predictor.load(tmp_path / "run")
    prediction = predictor(case)
    assert prediction.error_estimate_mm is not None
    assert np.isfinite(prediction.displacement).all()

"""Many patients: what is done, what is done again, and what does not stop the rest."""

import csv
import inspect
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from meshes import block_mesh
from physgnn import stages
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.io import read_mesh, write_mesh
from physgnn.io.medical.images.formats import write_image
from physgnn.stages import batch
from physgnn.stages.cohort.columns import columns_of
from physgnn.stages.cohort.running import PatientResult
from physgnn.stages.cohort.step_table import steps

COLUMNS = "name,case,points,noise_mm,image,interpolation\n"


@pytest.fixture
def cohort(tmp_path: Path) -> Path:
    """A folder with a mesh, an image, and points that moved down by 4 mm."""
    body = block_mesh(3, side=80.0)
    write_mesh(tmp_path / "block.vtu", body)
    top = body.points[body.point_set("loaded")]
    moved = np.hstack([top, top - [0.0, 0.0, 4.0]])
    np.savetxt(tmp_path / "moved.csv", moved, delimiter=",")
    affine = np.diag([8.0, 8.0, 8.0, 1.0])
    write_image(tmp_path / "t1.nii.gz", Image(np.ones((12, 12, 12)), affine))
    return tmp_path


def write_table(folder: Path, *lines: str) -> Path:
    path = folder / "patients.csv"
    path.write_text(COLUMNS + "".join(f"{line}\n" for line in lines))
    return path


def read_results(folder: Path) -> list[dict[str, str]]:
    with (folder / "results.csv").open(newline="") as stream:
        return list(csv.DictReader(stream))


def outcomes(results: tuple[PatientResult, ...]) -> list[tuple[str, str, str]]:
    return [(one.name, one.outcome, one.step) for one in results]


def test_what_asks_for_a_step_is_an_argument_of_its_stage() -> None:
    """`segment` waited for an argument that it had lost, and no scan could begin."""
    for step in steps():
        arguments = inspect.signature(getattr(stages, step.command)).parameters
        assert {*step.starts, *step.takes, *step.writes, *step.defaults} <= {*arguments}


def test_a_patient_goes_through_the_steps_its_cells_ask_for(cohort: Path) -> None:
    table = write_table(cohort, "Anna,block.vtu,moved.csv,0.5,t1.nii.gz,")
    (anna,) = batch(table, cohort / "out")
    assert anna.name == "Anna"
    assert anna.outcome in ("ok", "not ok")  # the evidence decides
    assert anna.figures["largest_mm"] == pytest.approx(4.0, abs=1.5)
    made = {path.name for path in (cohort / "out" / "Anna").iterdir()}
    files = {"shift.vtu", "misfits.csv", "deformed.nii.gz", "shift.h5", "slices.png"}
    assert made == files | {"patient.json", "log.txt"}
    alone = cohort / "alone.vtu"
    stages.register(
        cohort / "block.vtu", alone, points=cohort / "moved.csv", noise_mm=0.5
    )
    assert alone.read_bytes() == (cohort / "out" / "Anna" / "shift.vtu").read_bytes()


def test_what_a_stage_writes_is_no_column(cohort: Path) -> None:
    """A cell named a measurement of the next patient, and it was written over."""
    for name in ("misfits", "report", "picture", "out"):
        table = cohort / "written.csv"
        table.write_text(
            f"name,case,points,register.{name}\nAnna,block.vtu,moved.csv,half.csv\n"
        )
        with pytest.raises(InputError, match=f"unknown column 'register.{name}'"):
            batch(table, cohort / "out")


def test_no_step_has_a_column_for_what_it_writes() -> None:
    for step in steps():
        written = getattr(stages, step.command).outputs
        columns = {column.argument for column in columns_of([step]).values()}
        assert written and not columns & {*written}, step.command


def test_a_series_is_a_column_and_its_last_state_is_warped(cohort: Path) -> None:
    rows = np.loadtxt(cohort / "moved.csv", delimiter=",")
    np.savetxt(cohort / "half.csv", rows - [0, 0, 0, 0, 0, -2.0], delimiter=",")
    states = cohort / "states.csv"
    states.write_text("time,name,points\n0,opened,half.csv\n9,removed,moved.csv\n")
    table = cohort / "patients.csv"
    table.write_text(
        "name,case,register.series,noise_mm,image\nAnna,block.vtu,states.csv,0.5,t1.nii.gz\n"
        "Bo,block.vtu,lost.csv,0.5,t1.nii.gz\n"
    )
    anna, bo = batch(table, cohort / "out")
    assert (bo.outcome, bo.step) == ("failed", "register") and "lost.csv" in bo.reason
    assert anna.outcome in ("ok", "not ok") and anna.figures["states"] == 2
    assert anna.figures["largest_mm"] == pytest.approx(4.0, abs=1.5)
    made = cohort / "out" / "Anna"
    alone = stages.register(
        cohort / "block.vtu", cohort / "alone", series=states, noise_mm=0.5
    )
    assert anna.figures["status"] == alone[-1].figures["status"]
    last = (cohort / "alone" / "removed.vtu").read_bytes()
    assert (made / "states" / "removed.vtu").read_bytes() == last
    assert (made / "deformed.nii.gz").is_file()
    first = (made / "states" / "opened.vtu").stat().st_mtime_ns
    np.savetxt(cohort / "moved.csv", rows - [0, 0, 0, 0, 0, -1.0], delimiter=",")
    anna, _ = batch(table, cohort / "out")
    assert anna.figures["largest_mm"] < alone[-1].figures["largest_mm"]
    assert (made / "states" / "opened.vtu").stat().st_mtime_ns == first


def test_a_failure_is_named_and_the_others_go_on(cohort: Path) -> None:
    (cohort / "bad.csv").write_text("1,2,3\n")
    table = write_table(
        cohort,
        "Anna,block.vtu,bad.csv,,,",
        "Bo,block.vtu,moved.csv,much,,",
        "Cleo,missing.vtu,moved.csv,,,",
        "Dan,block.vtu,,,,",
        "Eve,,moved.csv,,,",
        "Fay,block.vtu,,,t1.nii.gz,",
        "Gus,block.vtu,moved.csv,,,nearest",
        "Hal,block.vtu,moved.csv,,,",
    )
    said: list[str] = []
    results = batch(table, cohort / "out", log=said.append)
    assert outcomes(results)[:-1] == [
        ("Anna", "failed", "register"),
        ("Bo", "failed", "register"),
        ("Cleo", "failed", "mesh"),
        ("Dan", "failed", ""),
        ("Eve", "failed", "register"),
        ("Fay", "failed", "warp"),
        ("Gus", "failed", "warp"),
    ]
    assert results[-1].outcome != "failed"
    reasons = [one.reason for one in results]
    assert "three columns, not six" in reasons[0]
    assert "register.noise_mm must be float (got 'much')" in reasons[1]
    assert f"there is no {cohort / 'missing.vtu'}" in reasons[2]
    assert "asks for nothing" in reasons[3]
    assert "nothing gives its mesh: fill in register.mesh or mesh." in reasons[4]
    assert "nothing gives its prediction: fill in warp.prediction" in reasons[5]
    assert "warp.interpolation alone asks for nothing" in reasons[6]
    assert said[0].startswith("Anna: failed: register: ")
    assert said[3].startswith("Dan: failed: its line asks for nothing (case is filled")
    rows = read_results(cohort / "out")
    assert [row["name"] for row in rows] == [one.name for one in results]
    assert rows[0]["reason"] == reasons[0]
    assert float(rows[-1]["largest_mm"]) > 0


def test_a_cell_that_nothing_would_use_is_named(cohort: Path) -> None:
    table = cohort / "unused.csv"
    table.write_text(
        "name,case,points,bone_noise_mm\nAnna,block.vtu,moved.csv,0.5\n", "utf-8"
    )
    (anna,) = batch(table, cohort / "out")
    assert (anna.outcome, anna.step) == ("failed", "register")
    assert "register.bone_noise_mm is of no use without register.bone" in anna.reason


def test_a_second_call_does_what_has_changed(
    cohort: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = write_table(
        cohort,
        "Anna,block.vtu,moved.csv,0.5,t1.nii.gz,",
        "Bo,block.vtu,other.csv,0.5,,",
    )
    (cohort / "other.csv").write_bytes((cohort / "moved.csv").read_bytes())
    first = batch(table, cohort / "out")
    done: list[str] = []
    for name in ("register", "warp"):
        function = getattr(stages, name)

        def noted(*args: object, _of: object = function, **named: object) -> object:
            done.append(f"{Path(str(named['out'])).parent.name}: {_of.__name__}")  # type: ignore[attr-defined]
            return _of(*args, **named)  # type: ignore[operator]

        noted.__signature__ = inspect.signature(function)  # type: ignore[attr-defined]
        monkeypatch.setattr(stages, name, noted, raising=False)
    again = batch(table, cohort / "out")
    assert done == []
    assert [one.figures for one in again] == [one.figures for one in first]
    assert outcomes(again) == outcomes(first)

    rows = np.loadtxt(cohort / "other.csv", delimiter=",")
    rows[:, 5] += 1.0
    np.savetxt(cohort / "other.csv", rows, delimiter=",")
    batch(table, cohort / "out")
    assert done == ["Bo: register"]

    (cohort / "out" / "Anna" / "slices.png").unlink()
    batch(table, cohort / "out")
    assert done[1:] == ["Anna: warp"]

    with (cohort / "out" / "Anna" / "shift.vtu").open("ab") as file:
        file.write(b"\n")  # changed by someone: made again, and so what follows is not
    batch(table, cohort / "out")
    assert done[2:] == ["Anna: register"]


def test_an_error_of_ours_is_one_patient_s_failure(
    cohort: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(mesh: str, out: str, *, points: str | Path | None = None) -> None:
        raise ZeroDivisionError(f"{mesh}{out}{points}")

    monkeypatch.setattr(stages, "register", broken, raising=False)
    table = write_table(cohort, "Anna,block.vtu,moved.csv,,,")
    table.write_text("name,case,points\nAnna,block.vtu,moved.csv\n")
    (anna,) = batch(table, cohort / "out")
    assert (anna.outcome, anna.step) == ("failed", "register")
    assert "an error in physgnn itself (ZeroDivisionError" in anna.reason
    log = (cohort / "out" / "Anna" / "log.txt").read_text()
    assert "Traceback" in log


def test_a_row_needs_a_stage_that_there_is() -> None:
    assert {"mesh", "adapt", "predict", "register", "warp"} <= {
        step.command for step in steps()
    }
    assert len({step.file for step in steps()}) == len(steps()) - 1  # one shift


@pytest.mark.slow
def test_ctrl_c_leaves_whole_files_and_a_table(cohort: Path) -> None:
    lines = [f"P{i},block.vtu,moved.csv,0.5,t1.nii.gz," for i in range(30)]
    table = write_table(cohort, *lines)
    code = "from physgnn.cli import command; command()"
    command = [sys.executable, "-c", code, "batch", str(table), "-o", "out"]
    with subprocess.Popen(command, cwd=cohort, stderr=subprocess.PIPE) as process:
        while not (cohort / "out" / "results.csv").exists():
            assert process.poll() is None
        os.kill(process.pid, signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    rows = read_results(cohort / "out")
    assert 1 <= len(rows) < 30
    left = [path for path in (cohort / "out").rglob("*") if path.name.startswith(".")]
    assert left == []
    for shift in (cohort / "out").rglob("shift.vtu"):
        assert read_mesh(shift).n_points > 0

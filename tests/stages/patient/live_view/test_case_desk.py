"""What the live view keeps of a case is what the commands write."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread, imsave

from meshes import block_mesh
from physgnn.config import read_preset
from physgnn.errors import InputError
from physgnn.geometry import boundary_surface
from physgnn.geometry.surface import Surface
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import read_mesh, write_mesh
from physgnn.io.untrusted.csv_table import SAFE_NAME
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.predictor import Predictor
from physgnn.serving.patient.desk import (
    FailedState,
    MeasuredState,
    RegisteredShift,
    RegisterOptions,
)
from physgnn.stages.patient.intraoperative.registration import register
from physgnn.stages.patient.live_view.case_desk import CaseDesk
from physgnn.stages.patient.live_view.case_states import rows_of
from physgnn.stages.patient.live_view.viewing import view
from physgnn.stages.patient.preoperative.case_file import init

SIDE = 80.0


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """A cube of 80 mm with a tumour below the middle of its top, held nowhere."""
    body = block_mesh(6, side=SIDE)
    centre = body.points[body.cells].mean(axis=1)
    near = np.linalg.norm(centre - [40, 40, 60], axis=1) < 16
    write_mesh(
        tmp_path / "case.vtu",
        TetMesh(body.points, body.cells, near.astype(np.int32)),
    )
    (tmp_path / "kept").mkdir()
    return tmp_path / "case.vtu"


def sunk_pairs(path: Path, mesh: TetMesh, depth_mm: float = 3.0) -> Path:
    """Pairs of points on the top, which has sunk most in the middle."""
    before = mesh.points[mesh.point_set("loaded")]
    away = np.linalg.norm(before[:, :2] - SIDE / 2, axis=1)
    after = before - [0, 0, 1] * (depth_mm * np.exp(-((away / 25) ** 2)))[:, None]
    np.savetxt(path, np.hstack([before, after]), delimiter=",")
    return path


def test_a_case_held_nowhere_is_opened_over_its_tumour(case: Path) -> None:
    desk = CaseDesk(case)
    assert "over the tumour" in desk.note
    opened, held = (desk.mesh.point_set(name) for name in ("loaded", "fixed"))
    assert (desk.mesh.points[opened, 2] == SIDE).all()
    assert len(held) and not np.isin(opened, held).any()
    desk.close()


def test_a_case_with_sets_keeps_them(case: Path) -> None:
    mesh = read_mesh(case).with_point_sets(fixed=np.arange(20))
    write_mesh(case, mesh)
    desk = CaseDesk(case)
    np.testing.assert_array_equal(desk.mesh.point_set("fixed"), np.arange(20))
    assert "click" not in desk.note
    desk.close()


def test_a_clicked_craniotomy_is_the_file_of_init(case: Path) -> None:
    kept = case.parent / "kept"
    desk = CaseDesk(case, kept)
    beside = np.array([SIDE + 4.0, 38.0, 41.0])  # a click is on a round picture
    assert desk.open(desk.opening(beside, 20.0)) == ["case.toml", "case.vtu"]
    point = case.with_name("point.csv")
    point.write_text("{},{},{}\n".format(*beside))
    (case.parent / "theirs").mkdir()
    init(case, case.parent / "theirs" / "case.toml", craniotomy=point, radius_mm=20.0)
    theirs = (case.parent / "theirs" / "case.toml").read_text()
    assert (kept / "case.toml").read_text() == theirs
    mesh, _ = read_preset(kept / "case.toml").on(read_mesh(case))
    for name in ("fixed", "loaded"):
        np.testing.assert_array_equal(desk.mesh.point_set(name), mesh.point_set(name))
        np.testing.assert_array_equal(
            read_mesh(kept / "case.vtu").point_set(name), mesh.point_set(name)
        )
    desk.close()


def test_what_is_kept_of_a_registration_is_what_the_command_writes(case: Path) -> None:
    kept, scratch = case.parent / "kept", case.parent
    desk = CaseDesk(case, kept)
    pairs = sunk_pairs(scratch / "pairs.csv", desk.mesh)
    moved = scratch / "tracker.txt"
    np.savetxt(moved, np.eye(4))
    around = np.array([[-5.0, 10, 70], [-5, 70, 75], [85, 40, 75], [40, 85, 70]])
    bone = scratch / "bone.csv"
    np.savetxt(bone, np.hstack([around, around + 0.1]), delimiter=",")
    files = {"pairs": pairs, "bone": bone, "initial transform": moved}
    state, options = MeasuredState("pairs", files), RegisterOptions(0.8, True)
    (shift,) = desk.register([state], scratch, options)
    names = ["case.vtu", "registered.vtu", "registered-misfits.csv"]
    assert desk.save([shift]) == names
    found = register(
        kept / "case.vtu",
        scratch / "command.vtu",
        points=pairs,
        bone=bone,
        initial_transform=moved,
        noise_mm=0.8,
        rigid_offset=True,
        misfits=scratch / "command.csv",
    )
    assert shift.found.bone is not None and shift.found.bone == found.bone
    for name, theirs in zip(names[1:], ("command.vtu", "command.csv"), strict=True):
        assert (kept / name).read_bytes() == (scratch / theirs).read_bytes()
    assert shift.found.prediction.displacement[:, 2].min() < -1.0
    desk.close()


def test_a_kept_series_is_the_folder_of_the_command(case: Path) -> None:
    kept, scratch = case.parent / "kept", case.parent
    (scratch / "view").mkdir()
    desk = CaseDesk(case, kept)
    rows, states = ["name,points"], []
    for name, depth in (("opened", 1.5), ("half", 3.0)):
        pairs = sunk_pairs(scratch / f"{name}.csv", desk.mesh, depth)
        states.append(MeasuredState(name, {"pairs": pairs}))
        rows.append(f"{name},{name}.csv")
    shifts = list(desk.register(states, scratch / "view", RegisterOptions()))
    assert desk.save(shifts) == ["case.vtu", "states/"]
    table = scratch / "states.csv"
    table.write_text("\n".join(rows) + "\n")
    register(kept / "case.vtu", scratch / "theirs", series=table)
    theirs = {file.name: file.read_bytes() for file in (scratch / "theirs").iterdir()}
    ours = {file.name: file.read_bytes() for file in (kept / "states").iterdir()}
    assert set(ours) == set(theirs) > {"series.pvd", "half.vtu", "half-misfits.csv"}
    timed = "results.csv"  # it has the seconds of each
    assert {k: v for k, v in ours.items() if k != timed} == {
        k: v for k, v in theirs.items() if k != timed
    }
    both = [
        read_table(folder / timed) for folder in (kept / "states", scratch / "theirs")
    ]
    assert both[0] == both[1]
    again = register(kept / "case.vtu", kept / "states", series=table)
    assert [state.seconds for state in again] == [0.0, 0.0]  # nothing is left to do
    assert desk.save(shifts)[1:] == ["states-2/"]
    desk.close()


def test_a_state_that_fails_is_named_and_does_not_stop_the_others(case: Path) -> None:
    kept, scratch = case.parent / "kept", case.parent
    (scratch / "view").mkdir()
    desk = CaseDesk(case, kept)
    there = sunk_pairs(scratch / "measured-1.csv", desk.mesh)
    bad = scratch / "measured-2.csv"
    bad.write_text("1,2,3,4,5,x\n")
    scan = scratch / "measured-3.nii.gz"
    scan.write_bytes(b"no scan")
    states = [
        MeasuredState("opened", {"pairs": there}, {"pairs": "opened.csv"}),
        MeasuredState("bad", {"pairs": bad}, {"pairs": "my points.csv"}),
        MeasuredState(
            "scan", {"intraoperative": scan}, {"intraoperative": "t1.nii.gz"}
        ),
        MeasuredState("again", {"pairs": there}, {"pairs": "again.csv"}),
    ]
    found = list(desk.register(states, scratch / "view", RegisterOptions()))
    good, *failed, last = found
    assert isinstance(good, RegisteredShift) and isinstance(last, RegisteredShift)
    reasons = [state.reason for state in failed if isinstance(state, FailedState)]
    assert reasons[0].startswith("my points.csv: point 1 must be 6 numbers")
    assert reasons[1].startswith("t1.nii.gz: expected a NIfTI image")
    assert desk.save(found) == ["case.vtu", "states/"]
    rows = read_table(kept / "states" / "results.csv")
    assert [row["outcome"] == "failed" for row in rows] == [False, True, True, False]
    assert [row["reason"] for row in rows[1:3]] == reasons
    assert "measured-" not in (kept / "states" / "results.csv").read_text()
    assert not (kept / "states" / "bad.vtu").exists()
    desk.close()


def test_the_outline_of_a_scan_is_kept_and_what_is_said_speaks_of_it(
    case: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from physgnn.stages.patient.intraoperative import one_state

    def surface(path: Path, *_: Any, picture: Path, log: Any, **__: Any) -> Surface:
        imsave(picture, np.zeros((2, 2)))
        log(f"{path}: brain, all of it: 500 ml; look at {picture}")
        return boundary_surface(desk.mesh)

    monkeypatch.setattr(one_state, "brain_surface", surface)
    kept, scratch = case.parent / "kept", case.parent
    (scratch / "view").mkdir()
    desk = CaseDesk(case, kept)
    scan = {"intraoperative": scratch / "measured-1.nii.gz"}
    states = [MeasuredState("scan", scan, {"intraoperative": "t2.nii.gz"})]
    options = RegisterOptions(chosen={"contrast": "t2"})
    (found,) = desk.register(states, scratch / "view", options)
    assert isinstance(found, RegisteredShift)
    said = "t2.nii.gz: brain, all of it: 500 ml; look at the saved registered.png"
    assert said in found.notes
    assert desk.save([found])[-1] == "registered.png"
    assert imread(kept / "registered.png").shape[:2] == (2, 2)
    desk.close()


def read_table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    return [{k: v for k, v in row.items() if k != "seconds"} for row in rows]


def test_states_get_names_that_suit_files_and_are_their_own(case: Path) -> None:
    files = {"pairs": case}
    names = ["a", "A", "../x y", "", "é 1"]
    rows = rows_of([MeasuredState(name, files) for name in names])
    assert [row.name for row in rows] == ["a", "A 2", "x y", "state", "é 1"]
    assert all(SAFE_NAME.fullmatch(row.name) for row in rows)
    assert [row.name for row in rows_of([MeasuredState("a", files)])] == ["registered"]


def test_nothing_is_written_without_a_folder(case: Path) -> None:
    desk = CaseDesk(case)
    there = sorted(case.parent.iterdir())
    assert desk.open(desk.opening(np.array([40.0, 40.0, SIDE]), 20.0)) == []
    with pytest.raises(InputError, match="--save FOLDER"):
        desk.save([])
    assert sorted(case.parent.iterdir()) == there
    desk.close()


def test_the_packages_network_is_adapted_to_the_craniotomy(case: Path) -> None:
    desk = CaseDesk(case)
    desk.open(desk.opening(np.array([SIDE, 40.0, 40.0]), 20.0))
    assert desk.adapts
    network = Predictor.load(desk.adapt())
    assert not desk.adapts and "adapted" in desk.note
    opened = desk.mesh.point_set("loaded")
    np.testing.assert_array_equal(network.body.fixed, desk.mesh.point_set("fixed"))
    push = np.tile([-0.5 / len(opened), 0.0, 0.0], (len(opened), 1))
    assert network(LoadCase(opened, push)).displacement[:, 0].min() < -0.1
    desk.close()


def test_a_network_needs_a_craniotomy_to_be_adapted_to(case: Path) -> None:
    write_mesh(case, read_mesh(case).with_point_sets(fixed=np.arange(20)))
    desk = CaseDesk(case)
    assert not desk.adapts
    with pytest.raises(InputError, match="click the craniotomy first"):
        desk.adapt()
    desk.close()


def test_what_cannot_be_used_is_one_line(case: Path) -> None:
    with pytest.raises(InputError, match="must name a folder that is there"):
        CaseDesk(case, case.parent / "absent")
    with pytest.raises(InputError, match="--save goes with a case"):
        view(None, save=case.parent)
    desk = CaseDesk(case)
    bad = case.with_name("bad.csv")
    bad.write_text("1,2,x\n")
    for files in ({"pairs": bad}, {"after": bad}, {"pairs": bad, "before": bad}):
        state = MeasuredState("bad", files)
        with pytest.raises(InputError) as error:
            next(desk.register([state], case.parent / "kept", RegisterOptions()))
        assert "\n" not in str(error.value)
        assert not list((case.parent / "kept").glob("*.vtu"))
    with pytest.raises(InputError, match="leave a part of the surface"):
        desk.opening(np.array([40.0, 40.0, SIDE]), 2 * SIDE)
    desk.close()

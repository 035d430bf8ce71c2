"""A series of states: each begun where the last ended, none lost, all as alone."""

from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import read_mesh, write_mesh
from physgnn.stages import register
from physgnn.stages.patient.intraoperative import one_state
from physgnn.stages.patient.intraoperative.patient_body import (
    ready_registrar,
)

SIDE = 80.0
DEPTHS = {"opened": 1.5, "half": 3.0, "out": 4.5}


def sunk(mesh: TetMesh, depth_mm: float) -> tuple[np.ndarray, np.ndarray]:
    before = mesh.points[mesh.point_set("loaded")]
    away = np.linalg.norm(before[:, :2] - SIDE / 2, axis=1)
    return before, before - [0, 0, 1] * (depth_mm * np.exp(-((away / 25) ** 2)))[
        :, None
    ]


@pytest.fixture
def theatre(tmp_path: Path) -> Path:
    """A cube, the points before, those of three states after, and their table."""
    mesh = block_mesh(5, side=SIDE)
    write_mesh(tmp_path / "case.vtu", mesh)
    rows = ["time,name,target"]
    for i, (name, depth) in enumerate(DEPTHS.items()):
        before, after = sunk(mesh, depth)
        np.savetxt(tmp_path / "before.csv", before, delimiter=",")
        np.savetxt(tmp_path / f"{name}.csv", after, delimiter=",")
        rows.append(f"{10 * i},{name},{name}.csv")
    (tmp_path / "states.csv").write_text("\n".join(rows) + "\n")
    return tmp_path


def run(theatre: Path, table: str = "states.csv", **more: object) -> tuple:
    return register(
        theatre / "case.vtu",
        theatre / "out",
        points=theatre / "before.csv",
        series=theatre / table,
        **more,
    )


def displacement(path: Path) -> np.ndarray:
    return np.asarray(pv.read(path)["displacement_mm"])


def test_every_state_is_what_it_is_alone(theatre: Path) -> None:
    ready = ready_registrar(theatre / "case.vtu")
    results = run(theatre, registrar=ready)
    assert [(one.name, one.time) for one in results] == [
        ("opened", 0.0),
        ("half", 10.0),
        ("out", 20.0),
    ]
    for name in DEPTHS:
        alone = register(
            theatre / "case.vtu",
            theatre / "alone.vtu",
            points=theatre / "before.csv",
            target=theatre / f"{name}.csv",
            registrar=ready,
        )
        moved = displacement(theatre / "out" / f"{name}.vtu")
        np.testing.assert_allclose(moved, alone.prediction.displacement, atol=0.01)
        kept = np.asarray(pv.read(theatre / "out" / f"{name}.vtu")["deviation_mm"])
        np.testing.assert_allclose(kept, alone.deviation_mm, rtol=0.02)


def test_paraview_finds_the_states_at_their_times(theatre: Path) -> None:
    run(theatre)
    reader = pv.PVDReader(theatre / "out" / "series.pvd")
    assert reader.time_values == [0.0, 10.0, 20.0]
    reader.set_active_time_value(20.0)
    read = reader.read()[0]
    kept = displacement(theatre / "out" / "out.vtu")
    np.testing.assert_array_equal(read["displacement_mm"], kept)
    rows = (theatre / "out" / "results.csv").read_text().splitlines()
    assert rows[0].startswith("name,time,outcome,reason,seconds,status")
    assert [row.split(",")[0] for row in rows[1:]] == list(DEPTHS)
    misfits = (theatre / "out" / "half-misfits.csv").read_text()
    assert misfits.startswith("kind,label,x_mm")


def test_what_is_done_is_not_done_again(
    theatre: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    original = one_state.read_measured

    def counted(files: one_state.MeasuredFiles, **how: object) -> list:
        asked.append(files.paths["target"].stem)
        if asked == ["opened", "half"]:
            raise KeyboardInterrupt
        return original(files, **how)

    monkeypatch.setattr(one_state, "read_measured", counted)
    with pytest.raises(KeyboardInterrupt):
        run(theatre)
    first = (theatre / "out" / "opened.vtu").read_bytes()
    whole = [one.outcome for one in run(theatre)]
    assert asked == ["opened", "half", "half", "out"]
    assert "failed" not in whole
    assert (theatre / "out" / "opened.vtu").read_bytes() == first
    run(theatre, noise_mm=2.0)  # another question: all anew
    assert asked[4:] == list(DEPTHS)


def test_a_failed_state_is_named_and_the_rest_goes_on(theatre: Path) -> None:
    (theatre / "half.csv").write_text("1,2,x\n")
    said: list[str] = []
    results = run(theatre, log=said.append)
    assert [one.outcome == "failed" for one in results] == [False, True, False]
    assert "half.csv" in results[1].reason
    assert any(line.startswith("half: failed: ") for line in said)
    assert not (theatre / "out" / "half.vtu").exists()
    reader = pv.PVDReader(theatre / "out" / "series.pvd")
    assert reader.time_values == [0.0, 20.0]


@pytest.mark.parametrize(
    ("table", "says"),
    [
        ("time,target\n10,half.csv\n5,out.csv\n", "line 3: time 5 comes after 10"),
        ("name,target\na,half.csv\nA,out.csv\n", "'A' is the name of line 2"),
        ("name,target\na,nowhere.csv\n", "line 2: target: there is no"),
        ("name,targets\na,half.csv\n", "unknown column 'targets'"),
        ("target\nhalf.csv\n", "expected a column name or time"),
        ("name,target\na/b,half.csv\n", "line 2: a state needs a time, or a name"),
        ("time,target\nsoon,half.csv\n", "time must be a number (got 'soon')"),
        ("name,target\na,half.csv,more\n", "3 cells under 2 columns"),
        ("name,target\n", "a line for each state"),
        ("name,surface\na,half.csv\n", "'a' has no points of its own"),
    ],
)
def test_a_bad_table_is_one_line_and_nothing_is_written(
    theatre: Path, table: str, says: str
) -> None:
    (theatre / "bad.csv").write_text(table)
    with pytest.raises(InputError) as error:
        run(theatre, "bad.csv")
    assert says in str(error.value) and "\n" not in str(error.value)
    assert not (theatre / "out").exists()


def test_a_registrar_of_another_mesh_is_refused(theatre: Path) -> None:
    ready = ready_registrar(theatre / "case.vtu")
    write_mesh(theatre / "case.vtu", block_mesh(4, side=SIDE))
    with pytest.raises(InputError, match="the registrar must be of this mesh"):
        run(theatre, registrar=ready)
    write_mesh(theatre / "case.vtu", ready.body.mesh)
    assert read_mesh(theatre / "case.vtu").n_points == ready.body.mesh.n_points
    with pytest.raises(InputError, match="skull of its own"):
        run(theatre, registrar=ready, skull="sliding")


def test_what_is_of_one_state_is_refused_of_a_series(theatre: Path) -> None:
    with pytest.raises(InputError, match="--misfits is for one state"):
        run(theatre, misfits=theatre / "m.csv")


@pytest.mark.parametrize("role", ["surface", "whole_surface", "target", "bone_target"])
def test_what_was_measured_once_is_not_taken_for_every_state(
    theatre: Path, role: str
) -> None:
    with pytest.raises(InputError, match=f"measured anew.*column '{role}'"):
        run(theatre, **{role: theatre / "half.csv"})
    assert not (theatre / "out").exists()


def test_bone_that_was_measured_once_vouches_for_no_later_state(theatre: Path) -> None:
    before, after = sunk(read_mesh(theatre / "case.vtu"), 2.0)
    np.savetxt(theatre / "bone.csv", np.hstack([before, after]), delimiter=",")
    with pytest.raises(InputError, match="line 2: 'opened' has no bone of its own"):
        run(theatre, bone=theatre / "bone.csv")

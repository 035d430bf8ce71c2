"""The commands for a patient never seen, as a user types them."""

from pathlib import Path

import pytest

from meshes import block_mesh
from physgnn.cli import main
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_mesh

LOADS = """
[loads]
total_force_n = 0.02
levels = 2
paths = 3
"""
TRAINING = """
model = "lifted"
max_epochs = 1
[options]
anchors = 2
k_hops = 1
width = 8
layers = 1
pod_modes = 0
"""


def run(*words: object) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["physgnn", *map(str, words)])
        try:
            main()
        except SystemExit as end:
            assert end.code == 0, end.code


def fails(*words: object) -> None:
    with pytest.raises(AssertionError, match="2"):
        run(*words)


def write_patient(path: Path, stretch: float) -> Path:
    mesh = block_mesh(3, jitter=0.1)
    points = mesh.points * [1.0, 1.3, stretch]
    write_mesh(path, TetMesh(points, mesh.cells, mesh.region, mesh.point_sets))
    return path


def test_from_a_family_to_a_new_patient(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    loads, training = tmp_path / "loads.toml", tmp_path / "training.toml"
    loads.write_text(LOADS)
    training.write_text(TRAINING)
    stores = []
    for k, stretch in enumerate((0.8, 1.7, 2.2)):
        case = write_patient(tmp_path / f"{k}.vtu", stretch)
        stores.append(tmp_path / f"{k}.zarr")
        run("simulate", case, "--loads", loads, "--workers", 1, "-o", stores[-1])
    family, new = tmp_path / "run", tmp_path / "new"
    run("train", *stores, "--config", training, "-o", family)
    case = write_patient(tmp_path / "new.vtu", 1.5)
    fails("adapt", family, case, "-o", new)
    assert "give --preset or --loads" in capsys.readouterr().err
    run("adapt", family, case, "--loads", loads, "-o", new)
    assert "error bounds that hold for 50 % of new patients" in capsys.readouterr().out
    tuned = tmp_path / "tuned"
    run("train", stores[0], "--from", family, "--config", training, "-o", tuned)
    fails(
        "train", *stores, "--config", training, "--split", "node", "-o", tmp_path / "x"
    )
    assert "split mesh only" in capsys.readouterr().err


def test_the_family_may_be_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "loads.toml").write_text(LOADS)
    loads = ("--loads", tmp_path / "loads.toml")
    case = write_patient(tmp_path / "case.vtu", 1.5)
    run("adapt", case, *loads, "-o", tmp_path / "first")
    run("adapt", "bundled-family", case, *loads, "-o", tmp_path / "second")
    said = capsys.readouterr().out.splitlines()
    assert [line.split(",")[0].split(": ")[1] for line in said] == ["64 points"] * 2
    fails("adapt", *loads, "-o", tmp_path / "third")
    assert "name the new patient's mesh" in capsys.readouterr().err


def test_a_family_has_members(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fails("anatomies", "--count", 0, "-o", tmp_path)
    assert "count must be ≥ 1" in capsys.readouterr().err


def test_a_batch_says_who_failed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, out = tmp_path / "patients.csv", tmp_path / "out"
    table.write_text("name,case,points\nAnna,no.vtu,a.csv\nBo,,b.csv\n")
    with pytest.raises(AssertionError, match="3"):
        run("batch", table, "-o", out)
    told = capsys.readouterr()
    assert f"Anna  failed: mesh: case: there is no {tmp_path / 'no.vtu'}" in told.out
    assert "0 of 2 patients ok" in told.out
    assert "Anna: failed: mesh" in told.err
    table.write_text("name,colour\nAnna,red\n")
    fails("batch", table, "-o", out)
    assert "unknown column 'colour'" in capsys.readouterr().err

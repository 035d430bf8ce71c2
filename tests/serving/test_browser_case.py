"""A case in a real browser: the craniotomy clicked, files dropped, the registration.

test_browser.py says what it takes. With PHYSGNN_PICTURES, a folder, the pictures are
kept there.
"""

import csv
import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista as pv
from case_on_show import case_engine, csv_of, sunk_pairs, write_case
from live_server import serving

from browser import browser_tools
from physgnn.config import read_preset
from physgnn.io import read_mesh
from physgnn.io.vtk.prediction_file import read_displacement
from physgnn.serving.sessions.engine import Engine

LEAST_CONTRAST = 4.5  # WCAG 2.2, success criterion 1.4.3


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("case")
    (folder / "kept").mkdir()
    (folder / "measured").mkdir()
    return folder


@pytest.fixture(scope="module")
def saw(folder: Path) -> dict[str, Any]:
    """What the browser saw; browse_case.mjs says what it did."""
    node, playwright, chromium = browser_tools()
    script, measured = Path(__file__).with_name("browse_case.mjs"), folder / "measured"
    with case_engine(write_case(folder), folder / "kept") as engine:
        write_measured(engine, measured)
        with serving(engine) as address:
            done = subprocess.run(
                [node, script, playwright, chromium, f"{address.page}/", measured],
                capture_output=True,
                text=True,
                timeout=400,
            )
    if os.environ.get("PHYSGNN_PICTURES"):
        for picture in measured.glob("*.png"):
            shutil.copy(picture, os.environ["PHYSGNN_PICTURES"])
    assert done.returncode == 0, done.stderr
    seen: dict[str, Any] = json.loads(done.stdout)
    return seen


def write_measured(engine: Engine, folder: Path) -> None:
    depths = {"pairs": 4.0, "state-2": 1.0, "state-10": 2.0}
    for name, depth in depths.items():
        pairs = csv_of(sunk_pairs(engine.viewed.body.mesh, depth))
        (folder / f"{name}.csv").write_bytes(pairs)
    np.savetxt(folder / "tracker.txt", np.eye(4))
    (folder / "scan.nii.gz").write_bytes(b"this is no image")
    (folder / "broken.csv").write_text("1,2,3,4,5,x\n")
    (folder / "picture.gif").write_bytes(b"GIF89a")


def test_the_page_has_no_errors_and_asks_nobody_else(saw: dict[str, Any]) -> None:
    assert saw["errors"] == []
    assert saw["elsewhere"] == []


def test_a_click_opens_the_skull_and_keeps_the_case_file(
    saw: dict[str, Any], folder: Path
) -> None:
    assert "no network was trained" in saw["note"] and "over the tumour" in saw["note"]
    assert "cm² open" in saw["tried"] and "the skull holds" in saw["tried"]
    assert saw["smaller"] != saw["tried"]
    assert not saw["loadedMeanwhile"]
    assert saw["opened"] == "Saved: case.toml, case.vtu."
    assert "click" not in saw["noteAfter"]
    kept = folder / "kept"
    mesh, paths = read_preset(kept / "case.toml").on(read_mesh(folder / "case.vtu"))
    opened = mesh.points[mesh.point_set("loaded")]
    assert np.linalg.norm(opened - [40, 40, 80], axis=1).max() <= 40
    assert len(paths) == 20
    np.testing.assert_array_equal(
        read_mesh(kept / "case.vtu").point_set("fixed"), mesh.point_set("fixed")
    )


def test_what_is_no_measured_file_is_one_clear_line(saw: dict[str, Any]) -> None:
    assert saw["refused"].startswith("picture.gif: measured files end in .csv")
    assert saw["broken"].startswith("broken.csv: point 1 must be 6 numbers")


def test_a_menu_is_there_where_a_file_calls_for_it(saw: dict[str, Any]) -> None:
    nothing = {"contrast": None, "transformed": None}
    contrasts = ["T1", "T1 with contrast agent", "T2", "FLAIR"]
    ends = ["points before and after", "points after, not before"]
    assert saw["menus"] == {
        "rest": nothing,
        "scan": {**nothing, "contrast": contrasts},
        "noScan": nothing,
        "transform": {**nothing, "transformed": ends},
    }
    asked = [one["chosen"] for one in saw["asked"]]
    after = {"transformed": "after"}
    assert asked == [{}, {"contrast": "flair"}, {}, after, after]
    assert saw["scan"].startswith("scan.nii.gz: expected a NIfTI image")


@pytest.mark.parametrize("when", ["rest", "registered", "failed"])
def test_nothing_is_cut_or_covered_in_narrow_windows(
    saw: dict[str, Any], when: str
) -> None:
    assert saw["misplaced"][when] == []


def test_a_dropped_file_is_registered_shown_and_saved(
    saw: dict[str, Any], folder: Path
) -> None:
    header = saw["header"]
    assert header["name"] == "pairs.csv"
    assert "exposed surface" in saw["roles"]
    assert saw["registered"].startswith("Misfit ")
    expected = "registered" if header["usable"] else header["status"]
    assert saw["chip"].startswith(expected.split(" ")[0])
    assert saw["reasons"] == header["reasons"]
    assert saw["legend"] == "Standard deviation, mm"
    assert len(saw["misfits"]) == len(header["misfits"]) > 0
    assert "registered.vtu" in saw["saved"]
    assert saw["found"]["Status"] == header["status"]
    for row, key in (("Error on average", "mean_mm"), ("Error at most", "max_mm")):
        assert saw["found"][row].startswith(f"{header['error'][key]:.2f} mm")
    offset = header["offset"]
    assert saw["found"]["Rigid offset"].startswith(f"{offset['length_mm']:.1f} mm, ")
    assert saw["found"]["Rigid offset"].endswith("% probable; not checked against bone")
    _, u = read_displacement(folder / "kept" / "registered.vtu")
    shown = np.reshape(saw["displaced"], (-1, 3))
    assert shown[:, 2].min() == pytest.approx(u[:, 2].min(), abs=1e-4)


def test_the_misfits_are_taken_away_as_the_file_that_is_saved(
    saw: dict[str, Any], folder: Path
) -> None:
    assert saw["csv"]["name"] == "registered-misfits.csv"
    ours = Path(saw["csv"]["path"]).read_bytes()
    assert ours == (folder / "kept" / "registered-misfits.csv").read_bytes()
    worst = max(float(row.split(",")[5]) for row in ours.decode().splitlines()[1:])
    assert saw["misfits"][0].split("\t")[1] == f"{worst:.2f}"


def test_text_can_be_read_in_both_themes(saw: dict[str, Any]) -> None:
    for name in ("dark", "light"):
        seen = saw[name]["contrast"]
        assert seen["texts"] > 40
        assert seen["ratio"] >= LEAST_CONTRAST, seen["text"]
        assert saw[name]["theme"][0] == "auto"
    assert saw["dark"]["theme"] != saw["light"]["theme"]


def test_a_theme_that_is_chosen_is_remembered(saw: dict[str, Any]) -> None:
    assert saw["chosen"] == ["dark", saw["dark"]["theme"][1]]
    assert saw["remembered"] == saw["chosen"]  # though the system is light


def test_a_load_hides_the_registration_until_it_is_wanted(saw: dict[str, Any]) -> None:
    assert "registration" not in saw["loaded"]


def test_the_packages_network_is_adapted_to_the_case(saw: dict[str, Any]) -> None:
    assert "adapted to this case" in saw["adapted"]["note"]
    assert saw["adapted"]["predictors"] == ["Network", "Linear"]


def test_several_files_are_a_series_in_the_order_of_their_numbers(
    saw: dict[str, Any],
) -> None:
    assert saw["order"] == ["pairs.csv", "state-2.csv", "state-10.csv", "tracker.txt"]
    assert saw["guessed"] == ["pairs", "pairs", "pairs", "initial transform"]
    assert saw["first"] == "pairs.csv + tracker.txt"
    assert saw["offset"].endswith("corrected; not checked against bone")


def test_a_series_is_saved_as_the_folder_of_the_command(
    saw: dict[str, Any], folder: Path
) -> None:
    assert saw["series"].endswith("states/.")
    kept = folder / "kept" / "states"
    with (kept / "results.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["name"] for row in rows] == ["pairs", "state-2", "state-10"]
    assert all((kept / f"{row['name']}-misfits.csv").is_file() for row in rows)
    assert pv.PVDReader(kept / "series.pvd").time_values == [1.0, 2.0, 3.0]


def test_a_failed_state_is_marked_and_the_others_are_shown(
    saw: dict[str, Any], folder: Path
) -> None:
    failed = saw["failed"]
    assert failed["shown"] == "state-10.csv + tracker.txt"
    (line,) = failed["lines"]
    assert line.startswith("State 1, broken.csv: point 1 must be 6 numbers")
    assert failed["marks"] == [line, "", "", ""]
    assert failed["value"] == "1 of 4, failed"
    assert failed["chip"] == "not registered"
    assert failed["source"] == "broken.csv + tracker.txt"
    assert failed["reasons"] == [line.removeprefix("State 1, ")]
    assert failed["predictions"] == [] and not failed["misfits"]
    assert failed["next"]["misfits"] and failed["next"]["chip"] != "not registered"
    assert "state-2.csv" in failed["next"]["source"]
    assert failed["saved"].endswith("states-2/.")
    table = (folder / "kept" / "states-2" / "results.csv").read_text().splitlines()
    assert table[1].startswith("broken,,failed,")
    assert not (folder / "kept" / "states-2" / "broken.vtu").exists()

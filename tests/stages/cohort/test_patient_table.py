"""Rows are patients, columns are options of the stages; mistakes name their line."""

from pathlib import Path

import pytest

from physgnn.errors import InputError
from physgnn.stages.cohort.columns import columns_of, find_column
from physgnn.stages.cohort.patient_table import read_patients
from physgnn.stages.cohort.step_table import steps


def table(folder: Path, text: str) -> Path:
    path = folder / "patients.csv"
    path.write_text(text, "utf-8")
    return path


def test_every_option_of_a_stage_is_a_column() -> None:
    columns = columns_of(steps())
    assert find_column("noise-mm", columns).name == "register.noise_mm"
    assert find_column("Segmentation", columns).name == "mesh.segmentation"
    assert find_column("image", columns).name == "warp.image"
    assert find_column("mesh.affine", columns).argument == "affine"
    assert "register.out" not in columns
    assert "warp.field" not in columns
    assert "register.log" not in columns
    with pytest.raises(
        InputError, match=r"adapt\.run or predict\.run: name it in full"
    ):
        find_column("run", columns)
    with pytest.raises(InputError, match=r"unknown column 'colour'.*noise_mm"):
        find_column("colour", columns)


def test_cells_are_read_by_column_and_empty_ones_left_out(tmp_path: Path) -> None:
    text = '\ufeffname,case,points,"noise mm"\n'.replace("noise mm", "noise-mm")
    text += "Anna,a.vtu,a.csv,\n\nBo 2,,b.csv,0.5\n"
    anna, bo = read_patients(table(tmp_path, text))
    assert (anna.name, bo.name) == ("Anna", "Bo 2")
    assert anna.cells == {"case": "a.vtu", "register.points": "a.csv"}
    assert bo.cells == {"register.points": "b.csv", "register.noise_mm": "0.5"}


@pytest.mark.parametrize("mark", [";", "\t"])
def test_semicolons_and_tabs_do_where_there_is_no_comma(
    mark: str, tmp_path: Path
) -> None:
    text = "name;mesh.labels\nAnna;brain=1,tumour=2\n".replace(";", mark)
    (anna,) = read_patients(table(tmp_path, text))
    assert anna.cells == {"mesh.labels": "brain=1,tumour=2"}


def test_an_unknown_column_is_told_each_of_the_others_once() -> None:
    with pytest.raises(InputError, match="unknown column") as raised:
        find_column("colour", columns_of(steps()))
    listed = str(raised.value).split("there are: ")[1].split(";")[0].split(", ")
    assert len(set(listed)) == len(listed) and {"name", "case"} < set(listed)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "a header and a line for each patient"),
        ("name,points\n", "a header and a line for each patient"),
        ("points\na.csv\n", "expected a column 'name'"),
        ("name,colour\nAnna,red\n", "unknown column 'colour'"),
        ("name,points,register.points\nAnna,a,b\n", "comes 2 times"),
        ("name,points\nAnna,a.csv\nANNA,b.csv\n", "line 3: 'ANNA' is in line 2"),
        ("name,points\n../x,a.csv\n", "line 2: a patient's name must suit a folder"),
        ("name,points\nresults.csv,a.csv\n", "must suit a folder"),
        ("name,points\n,a.csv\n", r"must suit a folder.*\(got ''\)"),
        ("name,points\nAnna,a,b\n", "line 2: 3 cells under 2 columns"),
    ],
)
def test_a_table_that_cannot_be_used(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as raised:
        read_patients(table(tmp_path, text))
    assert "patients.csv" in str(raised.value)

"""Columns of stretch and stress: units, header or none, and one line a mistake."""

from pathlib import Path

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.io.stress_curves import read_stress_curves

WHOLE = """\
tension_stretch,tension_stress_kpa,shear_amount,shear_stress_pa
1.00,0.00,0.00,0
1.05,0.10,0.10,60
1.10,0.20,0.20,120
1.15,0.30,0.30,180
"""
SIX = "\n".join(
    f"{1 + 0.1 * i}\t{0.2 * i}\t{1 - 0.1 * i}\t{-0.3 * i}\t{0.1 * i}\t{0.1 * i}"
    for i in range(4)
)


def read(folder: Path, text: str, **options: str) -> dict[str, tuple[list, list]]:
    (folder / "curves.csv").write_text(text, "utf-8")
    found = read_stress_curves(folder / "curves.csv", **options)
    return {c.kind: (c.amount.tolist(), c.stress_pa.tolist()) for c in found}


@pytest.mark.parametrize("separator", [",", ";", "\t", " ", ", "])
def test_a_header_names_columns_and_units(tmp_path: Path, separator: str) -> None:
    curves = read(tmp_path, WHOLE.replace(",", separator))
    assert curves == {
        "tension": ([1.0, 1.05, 1.1, 1.15], [0.0, 100.0, 200.0, 300.0]),
        "shear": ([0.0, 0.1, 0.2, 0.3], [0.0, 60.0, 120.0, 180.0]),
    }


@pytest.mark.parametrize(("unit", "pa"), [("kpa", 1e3), ("pa", 1.0)])
def test_the_unit_is_the_callers_where_the_file_names_none(
    tmp_path: Path, unit: str, pa: float
) -> None:
    curves = read(tmp_path, WHOLE.replace("stress_kpa", "stress"), unit=unit)
    assert np.allclose(curves["tension"][1], pa * np.array([0, 0.1, 0.2, 0.3]))
    assert curves["shear"][1][1] == 60.0, "its column is in Pa whatever the caller says"
    six = read(tmp_path, SIX, unit=unit)
    assert list(six) == ["tension", "compression", "shear"]
    assert np.allclose(six["compression"][1], pa * np.array([0, -0.3, -0.6, -0.9]))


def test_curves_of_several_lengths(tmp_path: Path) -> None:
    text = "\ufeff# from our machine\n" + WHOLE + "1.20,0.4,,\n\n"
    curves = read(tmp_path, text)
    assert (len(curves["tension"][0]), len(curves["shear"][0])) == (5, 4)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (WHOLE, "", "the file is empty"),
        (",shear_stress_pa", ",shear", "unknown column 'shear'"),
        ("stress_kpa", "stress_mpa", "unknown column 'tension_stress_mpa' (there are"),
        ("shear_amount", "shear_stretch", "unknown column 'shear_stretch'"),
        ("shear_amount", "tension_stretch", "two columns have the same name"),
        ("shear_amount", "tension_stress_pa", "tension has two columns of stress"),
        ("shear_amount", "compression_stretch", "'compression_stress_kpa' is missing"),
        ("shear_amount", "compression_stress", "'compression_stretch' is missing"),
        ("1.10,0.20,0.20,120", "1.10,0.20,0.20", "row 4 has 3 cells, and there are 4"),
        ("0.20,120", "0.20,many", "expected a number in line 3 of the data (got 'many"),
        ("0.20,120", "0.20,", "'shear_stress_pa': expected a number in line 3"),
        ("0.20,120", "0.20,nan", "(got 'nan')"),
        ("1.10,", "-1.10,", "tension: stretch must be > 0"),
        ("1.10,", "1.01,", "the load must grow from point to point"),
        ("1.15,0.30", ",", "tension: needs 3 points or more beside the rest state"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in WHOLE
    with pytest.raises(InputError, match=r"curves\.csv: ") as error:
        read(tmp_path, WHOLE.replace(old, new))
    assert message in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 0\n1.1 1\n", "without a header there must be six columns"),
        (SIX.replace("-0.3", "nan", 1), r"compression_stress.*\(got 'nan'\)"),
        ("tension_stretch,tension_stress\n", "tension: needs 3 points or more"),
        ("a\n1\n", "unknown column 'a'"),
    ],
)
def test_other_tables_are_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(tmp_path, text)


def test_no_text_at_all(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_stress_curves(tmp_path / "no.csv")
    with pytest.raises(InputError, match="cannot be read"):
        read_stress_curves(tmp_path)
    (tmp_path / "a.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="expected text in UTF-8"):
        read_stress_curves(tmp_path / "a.csv")
    with pytest.raises(InputError, match=r"kpa, pa \(got 'psi'\)"):
        read_stress_curves(tmp_path / "a.csv", unit="psi")
    with pytest.raises(InputError, match="leave --unit out"):
        read(tmp_path, WHOLE, unit="pa")  # the columns say kPa

"""fit-material: the table on standard output; one line and exit 2 for a mistake."""

import tomllib
from pathlib import Path

import pytest

from physgnn.cli import main

CURVE = "shear_amount,shear_stress_kpa\n0,0\n0.1,0.1\n0.2,0.22\n0.3,0.4\n0.4,0.7\n"


def call(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int | str | None:
    monkeypatch.setattr("sys.argv", ["physgnn", "fit-material", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main()
    return ended.value.code


def test_the_table_is_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.csv").write_text(CURVE)
    assert not call(monkeypatch, tmp_path / "a.csv", "--law", "neo-hookean")
    table = tomllib.loads(capsys.readouterr().out)
    assert table["materials"]["brain"]["law"] == "neo-hookean"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("shear_stress_kpa", "shear_stress_bar", "unknown column 'shear_stress_bar'"),
        ("shear_amount,", "", "column 'shear_amount' is missing beside"),
        ("0.22", "nan", "(got 'nan')"),
        ("0.2,", "0.4,", "give one loading branch"),
        ("0.2,0.22\n0.3,0.4\n", "", "needs 3 points or more"),
        ("0.1,0.1", "-0.1,0.1", "takes an amount of shear ≥ 0"),
    ],
)
def test_one_line_for_every_mistake(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    old: str,
    new: str,
    message: str,
) -> None:
    file, out = tmp_path / "a.csv", tmp_path / "a.toml"
    file.write_text(CURVE.replace(old, new))
    assert call(monkeypatch, file, "-o", out, "--chart", tmp_path / "a.png") == 2
    printed = capsys.readouterr()
    lines = printed.err.strip().splitlines()
    assert len(lines) == 1 and message in lines[0], printed.err
    assert printed.out == ""
    assert list(tmp_path.iterdir()) == [file]

"""The row of benchmarks: scripts that are there, tables read as they were printed."""

import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture(scope="module")
def bench():
    sys.path.insert(0, str(BENCHMARKS))
    try:
        import bench

        yield bench
    finally:
        sys.path.remove(str(BENCHMARKS))


def test_every_script_is_there_and_takes_its_arguments(bench):
    for row in bench.ROWS:
        assert (BENCHMARKS / row.script).is_file()
        source = (BENCHMARKS / row.script).read_text("utf-8")
        for word in (*row.arguments, *(row.quick or ())):
            assert not word.startswith("--") or f'"{word}"' in source


def test_tables_are_read_as_they_were_printed(bench, capsys):
    rows = [["10,000", "1.5"], ["a-b", "—"]]
    print("the machine\n\n## Growth\n")
    bench.table(("points", "s"), rows)
    print("\nOther")
    bench.table(("one",), [["-3"]])
    printed = capsys.readouterr().out.splitlines()
    first, second = bench.tables_in(printed)
    assert first == {"title": "Growth", "columns": ["points", "s"], "rows": rows}
    assert second == {"title": "Other", "columns": ["one"], "rows": [["-3"]]}


def test_what_needs_a_folder_says_so_and_what_is_kept_is_shown(tmp_path):
    (tmp_path / "commands.json").write_text(
        '{"command": ["waiting.py"], "seconds": 3, "tables": '
        '[{"title": "Kept", "columns": ["a"], "rows": [["17"]]}]}'
    )
    command = [sys.executable, BENCHMARKS / "bench.py", "-o", tmp_path]
    done = subprocess.run(
        [*command, "--only", "commands", "paths", "physgnn"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "| 17 |" in done.stdout
    assert "Not run: it needs --references FOLDER." in done.stdout
    assert "Not run: it needs --published FOLDER." in done.stdout

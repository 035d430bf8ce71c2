"""What a module of 3D Slicer says about mistakes, and how it takes its flags."""

from collections.abc import Callable
from pathlib import Path

import pytest

from physgnn.cli import slicer_launcher
from physgnn.cli.door import main
from physgnn.stages.slicer_modules.module_table import modules

Call = Callable[..., tuple[int, str, str]]


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Run a launcher's command; return exit code, standard output, standard error."""

    def run(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["launcher", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            main("physgnn.cli.slicer_launcher")
        printed = capsys.readouterr()
        code = ended.value.code
        return (code if isinstance(code, int) else 0), printed.out, printed.err

    return run


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("", "no module '' (there are: "),
        ("PhysGNNDream", "no module 'PhysGNNDream'"),
        ("PhysGNNRegister --mesh no.vtu --points a.fcsv", "name something to write"),
        (
            "PhysGNNRegister --shift x.vtu --noise_mm much",
            "must be double (got 'much')",
        ),
        ("PhysGNNRegister --shift x.vtu --skull soft", "must be one of fixed, sliding"),
        ("PhysGNNRegister --shift x.vtu --mesh no.vtu", "give --points"),
        ("PhysGNNPredict --shift x.vtu", "give a load file, or points to push"),
        ("PhysGNNMesh --mesh x.vtu", "give a label map"),
        ("PhysGNNWarp --labels --image", "nothing follows --image"),
        ("PhysGNNWarp --colour red", "has no --colour (there are: --deformed"),
    ],
)
def test_a_mistake_is_one_line_and_no_file(
    call: Call,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    words: str,
    said: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    code, _, err = call(*words.split())
    assert code == 2
    lines = [line for line in err.splitlines() if line.startswith("physgnn: ")]
    assert len(lines) == 1
    assert said in lines[0]
    assert not [*tmp_path.iterdir()]


def test_a_value_may_begin_with_a_dash_and_a_default_is_taken() -> None:
    module = next(m for m in modules() if m.name == "PhysGNNPredict")
    words = ["--force_n", "-1,0,-2.5", "--run=here", "--points", ""]
    given = slicer_launcher._given(module, words)
    values = slicer_launcher._values(module, given)
    assert values["force_n"] == [-1.0, 0.0, -2.5]
    assert values["run"] == "here"
    assert values["tolerance_mm"] == 0.0
    assert "points" not in values


def test_results_are_a_line_each(tmp_path: Path) -> None:
    file = tmp_path / "results.txt"
    slicer_launcher._write_results(str(file), {"status": "not\nok", "points": 3})
    assert file.read_text() == "status = not ok\npoints = 3\n"


def test_the_description_comes_without_torch_or_kernels() -> None:
    import subprocess
    import sys

    code = (
        "import sys; sys.argv = ['x', 'PhysGNNMesh', '--xml']\n"
        "from physgnn.cli.slicer_launcher import run; run()\n"
        "heavy = {'torch', 'numba', 'pyvista', 'dask'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "<title>Mesh</title>" in done.stdout

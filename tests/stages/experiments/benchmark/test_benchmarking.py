"""The benchmark, tiny: every method, resumed, strangers and failures among them."""

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import physgnn as pg
from physgnn.cli.door import main
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.evaluation.benchmark import load_measuring
from physgnn.evaluation.benchmark.methods import method_names
from physgnn.evaluation.benchmark.result import BenchmarkResult
from physgnn.evaluation.benchmark.tasks import BELOW_N, TASKS, TONUTTI
from physgnn.geometry.meshing import tetgen_process
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solver import Solver
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.stages.experiments.benchmark.benchmark_data import read_tonutti

TASK = "dataset-2-paths"
PROCESSOR_MINUTES = 5.0  # for all methods together
STRANGERS = '''
"""Methods of a stranger."""

import numpy as np

from physgnn.learning.surrogate import Surrogate


class Twice(Surrogate):
    """Twice the linear solution."""

    learns = False

    def predict(self, load_case):
        return 2.0 * self.linear(load_case)


class Bursts(Twice):
    """Raises what nobody expects."""

    def predict(self, load_case):
        raise RuntimeError("it burst\\nin two lines")


class Nowhere(Twice):
    """Has no numbers."""

    def predict(self, load_case):
        return np.full((self.body.mesh.n_points, 3), np.nan)


class Flat(Twice):
    """Has an array of another shape."""

    def predict(self, load_case):
        return np.zeros((1, 3))
'''

needs_tetgen = pytest.mark.skipif(
    not tetgen_process.available(), reason="needs the tetgen extra"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results that the tests of this module share."""
    return tmp_path_factory.mktemp("benchmark") / "results"


@pytest.fixture
def strangers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "strangers.py").write_text(STRANGERS)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "strangers", raising=False)


def code_of(*words: Any, monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.setattr(sys, "argv", ["physgnn", "benchmark", *map(str, words)])
    with pytest.raises(SystemExit) as end:
        main()
    return int(end.value.code or 0)


@needs_tetgen
@pytest.mark.usefixtures("strangers")
def test_a_strangers_methods_and_failures(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    names = [
        "strangers:Bursts",
        "strangers:Nowhere",
        "strangers:Flat",
        "strangers:Twice",
    ]
    words = ("--task", TASK, "--method", ",".join(names), "-o", folder)
    assert code_of(*words, monkeypatch=monkeypatch) == 3
    said = capsys.readouterr().out
    assert f"{TASK}, strangers:Bursts: failed, RuntimeError: it burst in two" in said
    assert "strangers:Nowhere: failed, predict returned numbers that are not" in said
    assert "strangers:Flat: failed, predict must return an array of shape" in said
    assert "strangers:Twice: mean" in said
    found = {r.identity.method: r for r in pg.benchmark(folder, task=TASK,
             method=",".join(names)).results}  # fmt: skip
    errors = {k: r.errors.all_points.mean for k, r in found.items() if r.errors}
    assert set(errors) == {"zero", "linear", "strangers:Twice"}
    assert errors["linear"] < errors["zero"]
    # u − 2 K₀⁻¹f is no longer than |u| and twice the linear solution's error
    assert errors["strangers:Twice"] <= errors["zero"] + 2 * errors["linear"]
    assert len(found["strangers:Twice"].identity.origin) == 64


@needs_tetgen
def test_what_is_there_is_not_made_anew_and_a_kill_loses_one_method(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pg.benchmark(folder, task=TASK, method="linear")
    made: list[str] = []
    really = load_measuring.measure

    def killed(row: Any, *args: Any, **options: Any) -> Any:
        made.append(row.name)
        if row.name == "decision-tree":
            raise SystemExit(143)  # as SIGTERM does
        return really(row, *args, **options)

    monkeypatch.setattr(load_measuring, "measure", killed)
    with pytest.raises(SystemExit):
        pg.benchmark(folder, task=TASK, method="linear-regression,decision-tree")
    assert made == ["linear-regression", "decision-tree"]
    monkeypatch.setattr(load_measuring, "measure", really)
    said: list[str] = []
    outcome = pg.benchmark(
        folder, task=TASK, method="linear-regression,decision-tree", log=said.append
    )
    assert len([line for line in said if "there already" in line]) == 3
    assert all(result.errors for result in outcome.results)


@needs_tetgen
@pytest.mark.slow
def test_all_methods_in_five_minutes(folder: Path, tmp_path: Path) -> None:
    begun = time.process_time()
    outcome = pg.benchmark(folder, task=TASK)
    assert time.process_time() - begun < 60 * PROCESSOR_MINUTES
    assert [result.identity.method for result in outcome.results] == [*method_names()]
    without = {r.identity.method for r in outcome.results if r.status != "measured"}
    # whole load paths are held out, and nothing was measured
    assert without == {"interpolation", "rigid", "spline", "register"}
    found = {r.identity.method: r for r in outcome.results}
    mean = {k: r.errors.all_points.mean for k, r in found.items() if r.errors}
    assert mean["repaired"] < 0.1  # mm: what it was repaired to
    assert mean["repaired"] < mean["lifted"] < mean["zero"]
    assert found["repaired"].processor_minutes == found["lifted"].processor_minutes
    assert mean["cnn"] < mean["zero"]
    for name in ("physgnn", "lifted", "meshgraphnet", "transolver", "cnn"):
        minutes = [minute for minute, _ in found[name].curve]
        assert minutes == sorted(minutes)
        assert len(minutes) > 0
    drawn = pg.benchmark(tmp_path / "page", report=folder)
    assert drawn.page is not None
    text = drawn.page.read_text("utf-8")
    assert "## Where networks and registration lose" in text
    assert f"## {TASK}, version {TASKS[TASK].version}, tiny" in text
    assert (tmp_path / "page" / "benchmark.svg").is_file()


@needs_tetgen
@pytest.mark.slow
@pytest.mark.parametrize("task", [name for name in TASKS if not TASKS[name].measured])
def test_every_task_runs(task: str, folder: Path) -> None:
    method = "linear,decision-tree,lifted,cnn,rigid"
    outcome = pg.benchmark(folder, task=task, method=method, minutes=0.02)
    status = {r.identity.method: r.status for r in outcome.results}
    never = task == "mesh-never-seen"
    tree = "not applicable" if never else "measured"
    assert status.pop("decision-tree") == tree
    assert status.pop("rigid") == "not applicable"
    assert set(status.values()) == {"measured"}
    for result in outcome.results:
        assert (result.errors is None) or result.errors.tumour is not None


@needs_tetgen
@pytest.mark.slow
@pytest.mark.parametrize("task", [name for name in TASKS if TASKS[name].measured])
def test_registrations_beside_their_peers(task: str, folder: Path) -> None:
    method = "rigid,spline,register,cnn,lifted,decision-tree"
    outcome = pg.benchmark(folder, task=task, method=method, minutes=0.02)
    found = {r.identity.method: r for r in outcome.results}
    no = {name for name, r in found.items() if r.status == "not applicable"}
    takes_loads = {"lifted", "decision-tree"}
    surface = task == "registration-surface"
    assert no == (takes_loads if surface else {*takes_loads, "cnn"})
    assert all(found[name].reason for name in no)
    mean = {k: r.errors.all_points.mean for k, r in found.items() if r.errors}
    assert len(mean) + len(no) == len(found)
    assert mean["register"] < mean["spline"] < mean["zero"] < mean["rigid"]
    for result in found.values():
        if result.errors is not None:
            assert result.errors.tumour is not None
            assert result.errors.n_samples == result.identity.data["test"]
    shifts = sorted((folder / "data" / "shifts-tiny").iterdir())
    written = [file.stat().st_mtime_ns for file in shifts]
    again = pg.benchmark(folder, task=task, method=method, minutes=0.02)
    assert again.results == outcome.results
    assert [file.stat().st_mtime_ns for file in shifts] == written


@pytest.mark.parametrize(
    ("module", "message"),
    [
        ("def def", "cannot be imported"),
        ("raise RuntimeError('no')", "cannot be imported"),
        (STRANGERS.replace("Twice(Surrogate)", "Other(Surrogate)").split("class Bur")[0]
         .replace("    learns", "    def __init__(self, body, *, width):\n"
                  "        super().__init__(body)\n\n    learns"),
         "must have a default"),
    ],
)  # fmt: skip
def test_a_stranger_that_cannot_be_made_is_refused_before_the_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: str, message: str
) -> None:
    (tmp_path / "unusable.py").write_text(module)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "unusable", raising=False)
    with pytest.raises(InputError, match=message):
        pg.benchmark(tmp_path / "out", task=TASK, method="unusable:Other")
    assert not (tmp_path / "out").exists()
    monkeypatch.delitem(sys.modules, "unusable", raising=False)


def test_tasks_without_data_are_named_and_none_at_all_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in [name for name in TASKS if TASKS[name].needs]:
        words = ("--task", name, "--size", "full", "--data", tmp_path)
        code = code_of(*words, "-o", tmp_path / "out", monkeypatch=monkeypatch)
        assert code == 2
        said = capsys.readouterr().err
        assert f"no task can be run: {name}: it needs {TASKS[name].needs}" in said
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"task": "magic"}, "no task 'magic'"),
        ({"method": "magic"}, "no method 'magic'"),
        ({"size": "vast"}, "size must be one of tiny, full"),
        ({"minutes": 0.0}, "minutes must be > 0"),
        ({"minutes": float("nan")}, "minutes must be > 0"),
        ({"method": "svr,rigid", "minutes": 1.0}, "svr,rigid has none"),
        ({"seed": -1}, "seed must be ≥ 0"),
        ({"report": "nowhere"}, "holds no results"),
        ({"size": "full", "task": "registration-surface"}, "mesh-never-seen in the"),
        ({"size": "full", "task": "dataset-1-paths"}, "paper-1.zarr in the folder"),
        ({"size": "full", "data": "nowhere"}, "must be a folder"),
    ],
)
def test_mistakes_are_one_line(
    tmp_path: Path, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        pg.benchmark(tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_another_dataset_under_the_tasks_name_is_refused(
    tmp_path: Path, block: Any
) -> None:
    path = LoadPath(block.point_set("loaded")[:1], [[0.0, 0.0, 1e-3]], [1.0])
    materials = {0: pg.NeoHookean(3000.0, 0.3), 1: pg.NeoHookean(3000.0, 0.3)}
    body = Body(block, materials, block.point_set("fixed"))
    Store.create(tmp_path / "paper-1.zarr", body, [path], provenance={})
    with pytest.raises(InputError, match=r"simulated with --preset paper-1 \(got None"):
        pg.benchmark(
            tmp_path / "results", task="dataset-1-paths", size="full", data=tmp_path
        )


def test_tonuttis_own_solution(shared: Path) -> None:
    """Their FEBio model's lengths over the tumour, at their first load."""
    file = shared / "real" / "tonutti2017.npz"
    if not file.is_file():
        pytest.skip("tonutti2017.npz is not there")
    mesh, theirs = read_tonutti(file), np.load(file)
    newton = float(theirs["load_newton"][0])
    assert newton < BELOW_N
    path = LoadPath(
        [int(theirs["load_node"])], newton * theirs["load_direction"][None], [1.0]
    )
    body = Body(mesh, TONUTTI.materials, mesh.point_set("fixed"))
    displacement = Solver(body).solve(path).displacement[0]
    length = np.linalg.norm(displacement[theirs["tumour_points"]], axis=1)
    np.testing.assert_allclose(length, theirs["displacement_length"][0], atol=1e-4)
    _, paths = TONUTTI.on(mesh)
    assert {int(p.nodes[0]) for p in paths} == set(theirs["force_points"].tolist())


def test_a_damaged_mesh_of_tonutti_is_named(tmp_path: Path) -> None:
    file = tmp_path / "tonutti2017.npz"
    np.savez(file, points=np.zeros((4, 3)))
    with pytest.raises(InputError, match="array 'cells' is missing"):
        read_tonutti(file)


def test_a_damaged_result_is_named(folder: Path, tmp_path: Path) -> None:
    del folder
    place = tmp_path / f"{TASK}-tiny"
    place.mkdir()
    (place / "linear-0.json").write_text(json.dumps({"format": "physgnn-benchmark"}))
    with pytest.raises(InputError, match=r"linear-0\.json"):
        BenchmarkResult.read(place / "linear-0.json")

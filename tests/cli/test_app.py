"""The command line: the whole way on a small block, and one line for every mistake."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
import torch

from physgnn.cli import main
from physgnn.dataset import Store
from physgnn.io import write_load_case
from physgnn.learning.physgnn.architecture import Architecture
from physgnn.learning.physgnn.network import PhysGNN
from physgnn.versions import release

STEPS = ("mesh", "simulate", "train", "evaluate", "predict")

Call = Callable[..., tuple[int, str, str]]


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Call the command line; return exit code, standard output, standard error."""

    def run(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["physgnn", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        printed = capsys.readouterr()
        code = ended.value.code
        return (code if isinstance(code, int) else 0), printed.out, printed.err

    return run


def test_help_lists_the_commands(call: Call) -> None:
    code, out, _ = call("--help")
    assert code == 0
    for name in (*STEPS, "export", "import", "published", "demo"):
        assert f"\n  {name} " in out


def test_the_release_is_said(call: Call) -> None:
    assert call("--version") == (0, f"physgnn {release('physgnn')}\n", "")


@pytest.mark.slow
def test_from_mesh_to_prediction(call: Call, folder: Path) -> None:
    store, run = folder / "loads.zarr", folder / "run"
    simulate = ("simulate", folder / "case.vtu", "--loads", folder / "loads.toml")
    code, out, err = call(*simulate, "--workers", 1, "-o", store)
    assert (code, "10 load paths solved now, 0 pending" in out) == (0, True), err
    assert "checked 2 of 20 levels against full Newton: largest difference" in out
    before = Store.open(store).content_hash()
    code, out, _ = call(*simulate, "-o", store)
    assert (code, "0 load paths solved now" in out) == (0, True)
    assert Store.open(store).content_hash() == before

    config = folder / "training.toml"
    code, out, err = call("train", store, "--config", config, "--seed", 3, "-o", run)
    assert (code, "validation loss" in out) == (0, True), err
    assert json.loads((run / "run.json").read_text())["config"]["seed"] == 3

    code, out, err = call("evaluate", run)
    assert (code, "Linear" in out) == (0, True), err
    assert (run / "evaluation-path" / "report.html").is_file()
    assert (run / "evaluation-path" / "metrics.json").is_file()

    case = Store.open(store).load_case(0, 1)
    write_load_case(folder / "load.json", case)
    predict = ("predict", run, "--load", folder / "load.json")
    code, out, err = call(*predict, "-o", folder / "out.vtu", "--linear")
    # two epochs make no network: whether it is called ok is for the evidence to say
    assert (code, " ok: " in out) in ((0, True), (3, False)), err
    assert "largest displacement" in out
    assert (folder / "out.vtu").is_file()
    repaired = ("--tolerance-mm", 0.1, "-o", folder / "repaired.vtu")
    code, out, err = call(*predict, *repaired)
    assert (code, "repaired: " in out or "solved: " in out) == (0, True), err


def test_loads_that_nothing_can_bear_are_no_success(call: Call, folder: Path) -> None:
    loads = (folder / "loads.toml").read_text().replace("0.02", "2e6")
    (folder / "loads.toml").write_text(loads.replace("paths = 10", "paths = 1"))
    of = ("simulate", folder / "case.vtu", "--loads", folder / "loads.toml")
    code, out, err = call(*of, "--workers", 1, "-o", folder / "loads.zarr")
    assert (code, "0 of 2 levels converged" in out) == (3, True), err
    assert "no level converged: is the mesh in mm" in err


def test_a_folder_that_is_missing_is_missed_before_the_work(
    call: Call, folder: Path
) -> None:
    out = folder / "nowhere" / "mesh.vtu"
    code, _, err = call("mesh", "--brain", folder / "no-surface.stl", "-o", out)
    assert (code, f"the folder {out.parent} is not there" in err) == (2, True)


def test_out_and_back(call: Call, folder: Path) -> None:
    store, loads = folder / "loads.zarr", ("--loads", folder / "loads.toml")
    call("simulate", folder / "case.vtu", *loads, "--workers", 1, "-o", store)
    export = ("export", folder / "case.vtu", "--path", 3, *loads)
    code, out, err = call(*export, "--febio", folder / "of-mesh.feb")
    assert (code, out.strip()) == (0, str(folder / "of-mesh.feb")), err
    export = ("export", store, "--path", 3)
    code, _, err = call(*export, "--febio", folder / "of-store.feb")
    assert code == 0, err
    of_mesh, of_store = (folder / f"of-{what}.feb" for what in ("mesh", "store"))
    assert of_mesh.read_text().replace("of-mesh", "of-store") == of_store.read_text()
    assert call(*export, "--series", folder / "three")[0] == 0
    assert call("export", store, "--arrays", folder / "all.npz")[0] == 0
    sources = ("import", folder / "all.npz", folder / "three")
    back = ("--materials", folder / "loads.toml", "-o", folder / "back.zarr")
    code, out, err = call(*sources, *back)
    assert (code, "11 load paths of 2 levels, 22 levels" in out) == (0, True), err
    ours, theirs = Store.open(store), Store.open(folder / "back.zarr")
    assert theirs.materials == ours.materials
    assert (theirs.displacement(10) == ours.displacement(3)).all()


def test_mistakes_are_one_line_and_leave_nothing(call: Call, folder: Path) -> None:
    case, loads, out = folder / "case.vtu", folder / "loads.toml", folder / "result.vtu"
    (folder / "wrong.toml").write_text(loads.read_text().replace("paths", "path"))
    for arguments, message in (
        (("mesh",), "give a label map, --brain, or --mni152"),
        (("mesh", "--brain", folder / "no.stl"), "no.stl"),
        (("simulate", case), "give --preset or --loads"),
        (
            ("simulate", case, "--preset", "paper-3"),
            "'paper-3' is not one of 'paper-1', 'paper-2', 'demo'",
        ),
        (("simulate", folder / "no.vtu", "--loads", loads), "no.vtu"),
        (("simulate", loads, "--loads", loads), "loads.toml"),
        (("simulate", case, "--loads", folder / "wrong.toml"), "unknown key 'path'"),
        (("simulate", case, "--loads", loads, "--workers", 0), "--workers"),
        (
            ("simulate", case, "--loads", loads, "--solver", "abaqus"),
            "'abaqus' is not one of 'physgnn', 'febio'",
        ),
        (("import", folder / "no.npz"), "no.npz: no such file"),
        (("import", case), "expected .feb, .npz, a folder of .vtu files"),
        (("train", folder / "no.zarr"), "no.zarr is not a dataset store"),
        (("train", case, "--model", "oracle"), "model must be one of"),
        (("predict", folder / "no-run", "--load", loads), "no-run is no finished run"),
    ):
        code, printed, err = call(*arguments, "-o", out)
        assert (code, printed) == (2, ""), (arguments, err)
        lines = [line for line in err.splitlines() if line.strip()]
        assert message in lines[-1], (arguments, err)
        assert "Traceback" not in err
        assert not out.exists(), arguments


def test_evaluating_no_run(call: Call, folder: Path) -> None:
    code, _, err = call("evaluate", folder)
    assert code == 2
    assert "is no run folder" in err


def test_weights_that_give_no_numbers_are_refused(call: Call, tmp_path: Path) -> None:
    network = PhysGNN(Architecture(3, 2))
    torch.nn.init.constant_(next(network.parameters()), float("nan"))
    torch.save(network.state_dict(), tmp_path / "weights.pt")
    code, out, err = call("published", tmp_path / "weights.pt")
    assert (code, out) == (2, "")
    assert "its output is not finite" in err


def test_published_weights_as_a_run(call: Call, folder: Path, tmp_path: Path) -> None:
    torch.manual_seed(0)
    torch.save(PhysGNN(Architecture(9, 1)).state_dict(), tmp_path / "weights.pt")
    weights = ("published", tmp_path / "weights.pt", "--configuration", 9)
    store, run = folder / "loads.zarr", tmp_path / "run"
    case, loads = folder / "case.vtu", folder / "loads.toml"
    code, _, err = call("simulate", case, "--loads", loads, "-o", store)
    assert code == 0, err
    code, _, err = call(*weights, "--store", store)
    assert code == 2
    assert "takes both a dataset" in err
    code, out, err = call(*weights, "--dataset", 1, "--store", store, "-o", run)
    assert code == 0, err
    assert f"{run}: a run of configuration 9" in out
    code, out, err = call("evaluate", run, "--split", "published")
    assert code == 0, err
    options = ("--config", tmp_path / "options.toml", "--max-epochs", 1, "--from", run)
    (tmp_path / "options.toml").write_text(
        '[options]\nconfiguration = 9\ndataset = 1\nnormaliser = "published"\n'
    )
    code, _, err = call("train", store, *options, "-o", tmp_path / "trained")
    assert code == 0, err
    code, _, err = call(*weights, "--store", store, "-o", run)
    assert code == 2
    assert "holds a run already" in err


def test_published(call: Call, shared: Path) -> None:
    paper = shared / "paper"
    options = ("--golden", paper / "golden_forward.npz", "--configuration", 3)
    code, out, err = call("published", paper / "config3_dataset2.pt", *options)
    assert code == 0, err
    assert float(out.split()[-2]) < 1e-4
    code, out, err = call("published", paper / "config3_dataset2.pt")
    assert code == 0, err
    assert "is finite" in out
    assert "not checked: whether they are of that configuration" in out
    code, _, err = call("published", paper / "golden_forward.npz", *options)
    assert code == 2
    options = ("--golden", paper / "brain.stl")
    code, _, err = call("published", paper / "config3_dataset2.pt", *options)
    assert code == 2
    assert "must be an .npz file with points, cells" in err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("register b.vtu -o u.vtu --bone-noise-mm 1", "without --bone or --series"),
        ("mesh --mni152 --labels brats -o c.vtu", "without the argument segmentation"),
        ("mesh seg.nii.gz --max-volume-mm3 2 -o c.vtu", "beside the argument seg"),
        ("benchmark -o page --report results --seed 2", "--seed is of no use beside"),
        ("benchmark -o r --size tiny --data .", "--data is for size full"),
        ("mesh --mni152 --target-points 9 --max-volume-mm3 2 -o c.vtu", "beside --max"),
        ("export c.vtu --febio a.feb --preset demo --loads l.toml", "beside --loads"),
        (
            "predict --load l.json --linear -o u.h5",
            "--linear writes the linear solution",
        ),
        ("predict --load l.json --image t1.nii -o u.vtu", "--image is for a field"),
        ("predict --load l.json -o u.nrrd", "--as labels"),
        ("ablate --panel width -o out", "panel must be all or one of"),
    ],
)
def test_an_option_that_nothing_would_use_is_one_line(
    call: Call, arguments: str, said: str
) -> None:
    code, out, err = call(*arguments.split())
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert said in err

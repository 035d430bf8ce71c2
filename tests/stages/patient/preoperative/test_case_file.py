"""A case file that `simulate` and `adapt` run as it is."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.config import read_preset
from physgnn.dataset import Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_mesh
from physgnn.prediction.predictor import Predictor
from physgnn.stages.datasets.simulation import simulate
from physgnn.stages.patient.preoperative.adaptation import adapt
from physgnn.stages.patient.preoperative.case_file import init


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """A cube of 80 mm with a tumour below the middle of its top."""
    body = block_mesh(8, side=80.0)
    centre = body.points[body.cells].mean(axis=1)
    near = np.linalg.norm(centre - [40, 40, 60], axis=1) < 14
    region = near.astype(np.int32)
    write_mesh(tmp_path / "case.vtu", TetMesh(body.points, body.cells, region))
    return tmp_path / "case.vtu"


def point(folder: Path, *places: tuple[float, float, float], system: str) -> Path:
    path = folder / "point.mrk.json"
    control = [{"position": place, "label": "c"} for place in places]
    markup = {"coordinateSystem": system, "controlPoints": control}
    path.write_text(json.dumps({"markups": [{"type": "Fiducial", **markup}]}))
    return path


def test_the_cortex_nearest_to_the_tumour_is_laid_open(case: Path) -> None:
    out = case.with_name("case.toml")
    said: list[str] = []
    found = init(case, out, radius_mm=20.0, log=said.append)
    np.testing.assert_allclose(found.centre_mm, [40, 40, 80])
    # ten-millimetre grid: the points of the top within 20 mm
    assert found.loaded.count == 13
    assert said[0].startswith("craniotomy at (40.0, 40.0, 80.0) mm: 13 points")
    mesh, paths = read_preset(out).on(_read(case))
    held, opened = mesh.point_set("fixed"), mesh.point_set("loaded")
    assert not np.intersect1d(held, opened).size
    assert (mesh.points[opened, 2] == 80).all() and (mesh.points[held, 2] < 80).all()
    assert len(paths) == 20


def test_a_point_beside_the_head_is_put_on_the_cortex(case: Path) -> None:
    out = case.with_name("case.toml")
    file = point(case.parent, (-92.0, -40.0, 40.0), system="LPS")
    found = init(case, out, craniotomy=file)
    np.testing.assert_allclose(found.centre_mm, [80, 40, 40])
    held = read_preset(out).on(_read(case))[0].point_set("fixed")
    assert _read(case).points[held, 0].max() < 80


def test_the_file_is_simulated_as_it_is(case: Path) -> None:
    out = case.with_name("case.toml")
    init(case, out, radius_mm=25.0)
    text = out.read_text().replace("paths = 20", "paths = 1")
    out.write_text(text.replace("levels = 10", "levels = 2"))
    store, did = simulate(case, case.with_name("s.zarr"), loads=out, workers=1)
    assert did.solved == 1 and isinstance(store, Store)
    assert len(store.samples()) == 2
    assert "[materials.tumour]" in text and "ventricle" not in text.split("[loads]")[1]


def test_what_cannot_be_a_craniotomy_is_refused(case: Path) -> None:
    out = case.with_name("case.toml")
    folder = case.parent
    far = point(folder, (300.0, 0.0, 0.0), system="RAS")
    with pytest.raises(InputError, match=r"outside of the head, 220 mm|outside of the"):
        init(case, out, craniotomy=far)
    turned = point(folder, (-60.0, -60.0, 80.0), system="RAS")
    with pytest.raises(InputError, match="look like LPS"):
        init(case, out, craniotomy=turned)
    two = point(folder, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), system="RAS")
    with pytest.raises(InputError, match="one point"):
        init(case, out, craniotomy=two)
    with pytest.raises(InputError, match="radius_mm"):
        init(case, out, radius_mm=1.0)
    with pytest.raises(InputError, match=r"\.toml"):
        init(case, folder / "other.vtu")
    body = block_mesh(3, side=80.0)
    whole = TetMesh(body.points, body.cells, np.zeros(body.n_cells, np.int32))
    write_mesh(folder / "plain.vtu", whole)
    with pytest.raises(InputError, match="no tumour"):
        init(folder / "plain.vtu", out)
    assert not out.exists()


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ((0.1405, 0.1395, 0.18), "looks like metres, so multiply it by 1000"),
        ((14.05, 13.95, 18.0), "looks like centimetres, so multiply it by 10"),
        ((140.0, 140.0, 142.0), "inside the brain, 38 mm from the surface"),
    ],
)
def test_a_point_in_other_units_or_deep_inside_is_no_craniotomy(
    tmp_path: Path, place: tuple[float, float, float], message: str
) -> None:
    """In metres it lay beside the origin, near which a cortex may pass."""
    cube = block_mesh(4, side=80.0)
    write_mesh(tmp_path / "case.vtu", replace(cube, points=cube.points + 100.0))
    (tmp_path / "point.csv").write_text("{},{},{}\n".format(*place))
    with pytest.raises(InputError, match=message):
        init(
            tmp_path / "case.vtu",
            tmp_path / "case.toml",
            craniotomy=tmp_path / "point.csv",
        )
    assert not (tmp_path / "case.toml").exists()


def _read(case: Path) -> TetMesh:
    from physgnn.io import read_mesh

    return read_mesh(case)


def with_sheets(case: Path) -> TetMesh:
    """The cube with a falx in its middle and a tentorium across."""
    mesh = _read(case)
    x, y, z = mesh.points.T
    sheets = {
        "falx": np.flatnonzero((x == 40) & (z > 30) & (z < 80)),
        "tentorium": np.flatnonzero((z == 30) & (y < 40) & (y > 0)),
    }
    mesh = mesh.with_point_sets(**sheets)
    write_mesh(case, mesh)
    return mesh


def test_sheets_of_the_mesh_are_a_table_that_runs_as_it_is(case: Path) -> None:
    out = case.with_name("case.toml")
    init(case, out, radius_mm=20.0)
    assert "[membranes]" not in out.read_text()
    without = read_preset(out).on(_read(case))[0].point_set("fixed")
    mesh = with_sheets(case)
    init(case, out, radius_mm=20.0)
    text = out.read_text()
    assert 'falx = "left-out"' in text and 'tentorium = "left-out"' in text
    for choice in ('"elastic"', '"held"', "stiffness_pa_per_mm"):
        assert choice in text
    as_it_is, _ = read_preset(out).on(mesh)
    np.testing.assert_array_equal(as_it_is.point_set("fixed"), without)
    out.write_text(text.replace('falx = "left-out"', 'falx = "held"'))
    held, _ = read_preset(out).on(mesh)
    expected = np.union1d(without, mesh.point_set("falx"))
    np.testing.assert_array_equal(held.point_set("fixed"), expected)
    out.write_text(text.replace('tentorium = "left-out"', 'tentorium = "elastic"'))
    _, paths = read_preset(out).on(mesh)
    assert all(len(path.more) == 1 for path in paths)


def test_adapt_takes_the_file_with_the_falx_held(case: Path) -> None:
    body = block_mesh(4, side=80.0)
    falx = np.flatnonzero((body.points[:, 0] == 40) & (body.points[:, 2] == 40))
    sheets = TetMesh(body.points, body.cells, np.zeros_like(body.region))
    mesh, out = sheets.with_point_sets(falx=falx), case.with_name("case.toml")
    write_mesh(case, mesh)
    top = point(case.parent, (40.0, 40.0, 80.0), system="RAS")
    init(case, out, craniotomy=top, radius_mm=30.0)
    text = out.read_text().replace('falx = "left-out"', 'falx = "held"')
    out.write_text(text.replace("paths = 20", "paths = 3"))
    made = adapt(None, case, case.with_name("run"), loads=out)
    assert made.n_points == mesh.n_points
    network = Predictor.load(case.with_name("run"))
    held = read_preset(out).on(mesh)[0].point_set("fixed")
    np.testing.assert_array_equal(network.body.fixed, held)
    assert np.isin(falx, held).all()

from pathlib import Path

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry import (
    HalfSpace,
    Surface,
    TetMesh,
    boundary_faces,
    boundary_surface,
    check_quality,
    paper_max_volume,
    select,
    tetrahedralize,
    volume,
)
from physgnn.geometry.meshing import tetgen_process
from physgnn.geometry.meshing.cell_quality import radius_edge_ratio
from physgnn.geometry.meshing.tetrahedra import (
    TETGEN,
    TETWILD,
    record,
)

pytest.importorskip("tetgen", reason="the mesher is an optional extra")


@pytest.fixture(scope="module")
def case(sphere) -> tuple[Surface, list[Surface]]:  # type: ignore[no-untyped-def]
    return sphere(20.0), [sphere(4.0, (8, 0, 0)), sphere(5.0, (-8, 0, 0))]


@pytest.fixture(scope="module")
def mesh(case: tuple[Surface, list[Surface]]) -> TetMesh:
    return tetrahedralize(*case)


def test_regions_have_the_volumes_of_the_surfaces(
    case: tuple[Surface, list[Surface]], mesh: TetMesh
) -> None:
    brain, tumours = case
    inside = sum(volume(tumour) for tumour in tumours)
    assert mesh.cell_volumes[mesh.region == 1].sum() == pytest.approx(inside)
    assert mesh.cell_volumes.sum() == pytest.approx(volume(brain))
    assert set(mesh.region) == {0, 1}


def test_surfaces_are_kept_and_come_first_sorted(
    case: tuple[Surface, list[Surface]], mesh: TetMesh
) -> None:
    brain, tumours = case
    points = np.concatenate([s.points for s in (brain, *tumours)])
    expected = np.unique(points, axis=0)
    np.testing.assert_array_equal(mesh.points[: len(expected)], expected)
    outer = boundary_surface(mesh)
    assert len(boundary_faces(mesh)) == brain.n_faces
    assert volume(outer) == pytest.approx(volume(brain))
    on_brain = mesh.points[np.unique(outer.faces)]
    np.testing.assert_array_equal(on_brain, np.unique(brain.points, axis=0))


def test_cells_keep_to_the_bounds(sphere, mesh: TetMesh) -> None:  # type: ignore[no-untyped-def]
    body = sphere(20.0)
    bound = 0.5 * paper_max_volume(body)
    fine = tetrahedralize(body, max_volume_mm3=bound)
    # TetGen lets some cells exceed it
    assert fine.cell_volumes.max() < 2.0 * bound
    assert np.percentile(fine.cell_volumes, 90) <= bound
    assert (fine.region == 0).all()
    assert np.percentile(radius_edge_ratio(mesh), 90) < 1.2


def test_paper_volume_rule_on_a_regular_tetrahedron() -> None:
    points = np.array([[1, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1.0]])
    faces = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
    body = Surface(points, faces)
    assert paper_max_volume(body) == pytest.approx(2.0 * abs(volume(body)))


def test_any_order_of_points_and_faces_gives_the_same_points(sphere) -> None:  # type: ignore[no-untyped-def]
    body = sphere()
    order = np.random.default_rng(0).permutation(body.n_points)
    shuffled = Surface(body.points[order], np.argsort(order)[body.faces])
    one, other = tetrahedralize(body), tetrahedralize(shuffled)
    np.testing.assert_array_equal(one.points, other.points)


def test_target_points(sphere) -> None:  # type: ignore[no-untyped-def]
    lines: list[str] = []
    found = tetrahedralize(sphere(20.0), target_points=5000, log=lines.append)
    assert found.n_points == pytest.approx(5000, rel=0.06)
    assert 1 <= len(lines) <= 6
    assert f"{found.n_points} points, {found.n_cells} cells" in "".join(lines)


def test_unreachable_target_is_said(sphere) -> None:  # type: ignore[no-untyped-def]
    lines: list[str] = []
    found = tetrahedralize(
        sphere(20.0, refinements=4), target_points=1000, log=lines.append
    )
    assert f"{found.n_points} points is the nearest to 1000" in lines[-1]


def test_the_record_says_whether_another_run_gives_the_same_mesh() -> None:
    assert "the same mesh" in record(TETGEN) and "other points" in record(TETWILD)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"max_volume_mm3": 0.0}, "max_volume_mm3 must be > 0"),
        ({"max_volume_mm3": float("nan")}, "max_volume_mm3 must be > 0"),
        ({"target_points": 10}, "target_points must be in"),
        ({"target_points": 5000, "max_volume_mm3": 1.0}, "not both"),
        ({"quality_ratio": 1.0}, "quality_ratio must be in"),
    ],
)
def test_refuses_options_out_of_range(sphere, options, message) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=message):
        tetrahedralize(sphere(), **options)


def test_a_missing_mesher_names_the_extra(sphere, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(tetgen_process, "available", lambda: False)
    with pytest.raises(InputError, match=r"pip install 'physgnn\[tetgen\]'"):
        tetrahedralize(sphere(), mesher="tetgen")
    with pytest.raises(InputError, match="tetwild, tetgen"):
        tetrahedralize(sphere(), mesher="gmsh")


def test_what_tetgen_cannot_mesh_is_an_error_of_ours(sphere) -> None:  # type: ignore[no-untyped-def]
    """TetGen corrupts memory on one of these; the process survives."""
    open_surface = Surface(sphere().points, sphere().faces[1:])
    crossing = [sphere(10.0, (8, 0, 0))]
    for brain, tumours in ((open_surface, []), (sphere(), crossing)):
        with pytest.raises(InputError, match="TetGen could not mesh") as caught:
            tetrahedralize(brain, tumours)
        assert "\n" not in str(caught.value)


def test_a_run_that_hangs_is_stopped(sphere) -> None:  # type: ignore[no-untyped-def]
    body = sphere()
    with pytest.raises(RuntimeError, match=r"more than 0\.01 s"):
        tetgen_process.run(body.points, body.faces, "pq1.2AaY", timeout_s=0.01)


def test_the_paper_mesh(shared: Path) -> None:
    """TetGen 1.6 as in the tetgen wheel; the points of the reference to the bit."""
    from physgnn.io import read_surface

    brain, tumour = (
        read_surface(shared / "paper" / f"{name}.stl") for name in ("brain", "tumour")
    )
    mesh = tetrahedralize(brain, [tumour])
    assert (mesh.n_points, mesh.n_cells) == (9444, 55_996)
    check_quality(mesh)
    with np.load(shared / "febio" / "febio_ds2_path1.npz") as reference:
        np.testing.assert_array_equal(mesh.points, reference["points"])
        np.testing.assert_array_equal(
            labelled_cells(mesh.cells, mesh.region),
            labelled_cells(reference["cells"], reference["region"]),
        )
        fixed = select(mesh, HalfSpace((20, 0), (80, 90, 120), "<", 265.0))
        np.testing.assert_array_equal(fixed, np.sort(reference["fixed"]))
        loaded = select(mesh, HalfSpace((200, 0), (80, 110, 130), "<=", -32.4))
        np.testing.assert_array_equal(loaded, np.sort(reference["load_nodes"]))


def labelled_cells(cells: np.ndarray, region: np.ndarray) -> np.ndarray:
    """Cells with their region, in an order that only depends on what they are."""
    rows = np.column_stack([np.sort(cells, axis=1), region])
    return rows[np.lexsort(rows.T)]

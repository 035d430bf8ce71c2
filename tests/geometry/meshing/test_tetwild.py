"""fTetWild, the mesher that every installation has."""

import numpy as np
import pytest
import pyvista as pv

from physgnn.errors import InputError
from physgnn.geometry import (
    Surface,
    TetMesh,
    boundary_surface,
    merge,
    quality,
    tetrahedralize,
    volume,
)
from physgnn.geometry.boundary import region_faces
from physgnn.geometry.meshing import tetgen_process, tetwild_process
from physgnn.geometry.meshing.tetrahedra import paper_max_volume
from physgnn.geometry.meshing.tetwild import ENVELOPE_MM, edge_of


@pytest.fixture(scope="module")
def case(sphere) -> tuple[Surface, list[Surface]]:  # type: ignore[no-untyped-def]
    return sphere(40.0), [sphere(8.0, (16, 0, 0)), sphere(10.0, (-16, 0, 0))]


@pytest.fixture(scope="module")
def mesh(case: tuple[Surface, list[Surface]]) -> TetMesh:
    """As an installation without the extra meshes it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tetgen_process, "available", lambda: False)
        return tetrahedralize(*case, target_points=1500)


def test_regions_have_the_volumes_of_the_surfaces(
    case: tuple[Surface, list[Surface]], mesh: TetMesh
) -> None:
    brain, tumours = case
    inside = sum(volume(tumour) for tumour in tumours)
    assert mesh.cell_volumes[mesh.region == 1].sum() == pytest.approx(inside, rel=0.02)
    assert mesh.cell_volumes.sum() == pytest.approx(volume(brain), rel=0.005)
    assert mesh.n_points == pytest.approx(1500, rel=0.2)


def test_surfaces_stay_within_the_envelope(
    case: tuple[Surface, list[Surface]], mesh: TetMesh
) -> None:
    brain, tumours = case
    for faces, given in (
        (boundary_surface(mesh).faces, [brain]),
        (region_faces(mesh, 1), tumours),
    ):
        whole = merge(given)
        points = mesh.points[np.unique(faces)]
        triangles = pv.PolyData.from_regular_faces(
            whole.points, whole.faces.astype(int)
        )
        _, nearest = triangles.find_closest_cell(points, return_closest_point=True)
        off = np.linalg.norm(points - nearest, axis=1)
        assert off.max() < 1.5 * ENVELOPE_MM


def test_cells_are_better_than_tetgens_worst(mesh: TetMesh) -> None:
    assert quality(mesh).mean_ratio_min > 0.2


def test_the_published_rule_means_the_same_edge() -> None:
    points = np.array([[1, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1.0]])
    body = Surface(points, np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]))
    assert edge_of(paper_max_volume(body)) == pytest.approx(np.sqrt(8.0))


def test_a_surface_that_is_lost_is_refused(sphere, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    body, tumour = sphere(40.0), sphere(20.0)

    found = tetrahedralize(body, max_volume_mm3=400.0, mesher="tetwild")
    assert (found.region == 0).all()
    monkeypatch.setattr(
        tetwild_process,
        "run",
        lambda *_, **__: (found.points * 0.5, found.cells),
    )
    with pytest.raises(InputError, match="must keep the surfaces"):
        tetrahedralize(body, [tumour], mesher="tetwild", max_volume_mm3=400.0)


def test_a_run_that_hangs_or_fails_is_one_line(sphere, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    body = sphere()
    with pytest.raises(RuntimeError, match=r"more than 0\.01 s"):
        tetwild_process.run(body.points, body.faces, 1.0, envelope=1e-3, timeout_s=0.01)

    def fails(*_, **__):  # type: ignore[no-untyped-def]
        raise RuntimeError("out of memory")

    monkeypatch.setattr(tetwild_process, "run", fails)
    with pytest.raises(InputError, match=r"fTetWild could not mesh .*--mesher tetgen"):
        tetrahedralize(body, mesher="tetwild")

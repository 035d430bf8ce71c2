from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

from physgnn.errors import InputError
from physgnn.geometry import Surface, boundary_points, volume
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_mesh, write_prediction
from physgnn.io.vtk.prediction_file import read_displacement, write_deformed


def test_displacement_comes_back(block: TetMesh, tmp_path: Path) -> None:
    u = np.random.default_rng(0).normal(size=block.points.shape)
    write_prediction(tmp_path / "out.vtu", block, {"displacement_mm": u})
    mesh, back = read_displacement(tmp_path / "out.vtu")
    np.testing.assert_array_equal(back, u)
    assert mesh.content_hash == block.content_hash
    write_mesh(tmp_path / "case.vtu", block)
    with pytest.raises(InputError, match="physgnn predict"):
        read_displacement(tmp_path / "case.vtu")


def test_deformed_body_is_where_it_moves_to(block: TetMesh, tmp_path: Path) -> None:
    u = 0.1 * block.points
    write_deformed(tmp_path / "moved.vtu", block, u)
    write_deformed(tmp_path / "moved.vtp", block, u)
    body, surface = pv.read(tmp_path / "moved.vtu"), pv.read(tmp_path / "moved.vtp")
    np.testing.assert_allclose(body.points, block.points + u)
    brain = surface.extract_cells(surface.cell_data["region"] == 0)
    assert brain.n_points == len(boundary_points(block))
    tumour = surface.regular_faces[surface.cell_data["region"] == 1]
    inside = block.cell_volumes[block.region == 1].sum()
    moved = Surface(surface.points, tumour)
    assert volume(moved) == pytest.approx(1.1**3 * inside)
    for data in (body, surface):
        rest = data.points - data.point_data["displacement_mm"]
        np.testing.assert_allclose(rest.min(axis=0), 0, atol=1e-5)
        np.testing.assert_allclose(rest.max(axis=0), 10, atol=1e-5)
        assert list(data.field_data["SPACE"]) == ["RAS"]  # what 3D Slicer looks for
    with pytest.raises(InputError, match="deformed already"):
        read_displacement(tmp_path / "moved.vtu")
    with pytest.raises(InputError, match=r"\.vtu or \.vtp"):
        write_deformed(tmp_path / "moved.stl", block, u)


def test_displacements_that_no_body_has(block: TetMesh, tmp_path: Path) -> None:
    def written(u: np.ndarray, scale: float = 1.0) -> Path:
        mesh = TetMesh(block.points * scale, block.cells, block.region)
        write_prediction(tmp_path / "out.vtu", mesh, {"displacement_mm": u})
        return tmp_path / "out.vtu"

    u = np.full_like(block.points, 0.1)
    holed = u.copy()
    holed[5, 1] = np.nan
    for field, scale, said in (
        (holed, 1.0, r"1 of \d+ points have NaN or infinity, the first is 5"),
        (1e4 * u, 1.0, r"out\.vtu: .*must be in mm \(a point moves by 1.73e\+03"),
        (u, 1e-3, "looks like metres"),
    ):
        with pytest.raises(InputError, match=said):
            read_displacement(written(field, scale))
    with pytest.raises(InputError, match="make a displacement with 'physgnn predict'"):
        read_displacement(tmp_path / "no.vtu")

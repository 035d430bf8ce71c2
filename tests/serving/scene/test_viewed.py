from pathlib import Path

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_mesh
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.serving.scene.viewed import view


def test_a_mesh_is_shown_with_linear_elasticity(block: TetMesh, tmp_path: Path) -> None:
    write_mesh(tmp_path / "case.vtu", block)
    viewed = view(tmp_path / "case.vtu")
    assert list(viewed.predictors) == ["linear"]
    np.testing.assert_array_equal(viewed.exposed.nodes, block.point_set("loaded"))
    case = LoadCase(viewed.exposed.nodes[:1], np.array([[0.0, 0.0, -0.01]]))
    assert viewed.predictors["linear"](case).displacement.any()
    assert viewed.reasons_outside(case) == []


def test_without_a_set_of_loaded_points_all_that_is_free_is_exposed(
    block: TetMesh, tmp_path: Path
) -> None:
    sets = {"fixed": block.point_set("fixed")}
    bare = TetMesh(block.points, block.cells, block.region, sets)
    write_mesh(tmp_path / "case.vtu", bare)
    exposed = view(tmp_path / "case.vtu").exposed.nodes
    assert not np.isin(exposed, sets["fixed"]).any()
    assert np.isin(block.point_set("loaded"), exposed).all()


@pytest.mark.parametrize("name", ["brain.stl", "absent.vtu", "."])
def test_what_cannot_be_shown_is_one_clear_line(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError) as error:
        view(tmp_path / name)
    assert "\n" not in str(error.value)


def test_a_mesh_that_nothing_holds_says_which_set_it_lacks(
    block: TetMesh, tmp_path: Path
) -> None:
    write_mesh(tmp_path / "case.vtu", TetMesh(block.points, block.cells, block.region))
    with pytest.raises(InputError, match="'fixed'"):
        view(tmp_path / "case.vtu")

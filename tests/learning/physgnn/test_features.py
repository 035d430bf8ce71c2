from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from physgnn.dataset.presets import PRESETS
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.physgnn.features import (
    force_features,
    load_features,
    physical_property,
)

components = st.floats(-10, 10).filter(lambda f: f == 0 or abs(f) > 1e-6)
forces = arrays(np.float64, (3, 3), elements=components)


@given(forces)
def test_angles_and_size_say_the_force_up_to_the_sign_of_x(force: np.ndarray) -> None:
    x, y, z, size, phi, theta = force_features(force).T
    np.testing.assert_array_equal(np.stack([x, y, z], 1), force)
    np.testing.assert_allclose(size, np.linalg.norm(force, axis=1))
    across = size * np.sin(phi)
    np.testing.assert_allclose(size * np.cos(phi), z, atol=1e-6)
    np.testing.assert_allclose(across * np.sin(theta), y, atol=1e-6)
    np.testing.assert_allclose(across * np.cos(theta), np.abs(x), atol=1e-6)


def test_no_force_and_forces_along_an_axis_give_finite_numbers() -> None:
    columns = force_features(np.array([[0.0, 0, 0], [0, 0, 2], [0, 0, -2], [0, -1, 0]]))
    expected = [[0, 0], [0, 0], [np.pi, 0], [np.pi / 2, -np.pi / 2]]
    np.testing.assert_allclose(columns[:, 4:], expected, atol=1e-15)


def test_property_of_fixed_wins_over_tumour_wins_over_brain(block: TetMesh) -> None:
    tumour = np.unique(block.cells[block.region == 1])
    kind = physical_property(block, fixed=tumour[:2])
    assert (kind[tumour[:2]] == 0.0).all()
    assert (kind[tumour[2:]] == 0.4).all()
    assert (np.delete(kind, tumour) == 1.0).all()


@pytest.mark.parametrize("dataset", [1, 2])
def test_published_inputs_follow_from_mesh_and_load(shared: Path, dataset: int) -> None:
    golden = np.load(shared / "paper" / "golden_forward.npz")
    mesh = TetMesh(golden["points"], golden["cells"], golden["region"])
    mesh, paths = PRESETS[f"paper-{dataset}"].on(mesh)
    path, level = golden[f"sample_{dataset}"]  # level counts from 1
    columns = load_features(paths[path].case(level - 1), mesh.n_points)
    scaled = columns - golden[f"feature_mean_{dataset}"]
    scaled /= golden[f"feature_std_{dataset}"]
    kind = physical_property(mesh, mesh.point_set("fixed"))
    np.testing.assert_allclose(
        np.column_stack([kind, scaled]), golden[f"x_{dataset}"], atol=1e-5
    )

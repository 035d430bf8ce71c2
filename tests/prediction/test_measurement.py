import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.prediction.measurement import surface_interpolation


@given(st.integers(0, 2**32 - 1))
def test_linear_fields_are_exact_on_the_surface(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mesh = block_mesh(3, jitter=0.15)
    points = rng.uniform(0, 10, (20, 3))
    points[np.arange(20), rng.integers(0, 3, 20)] = rng.choice([0.0, 10.0], 20)
    P = surface_interpolation(mesh, points)
    np.testing.assert_allclose(P @ mesh.points, points, atol=1e-5)
    np.testing.assert_allclose(P.sum(axis=1), 1.0)
    assert P.data.min() > -1e-5


def test_a_point_off_the_surface_takes_the_place_nearest_to_it() -> None:
    mesh = block_mesh(3)
    P = surface_interpolation(mesh, np.array([[5.0, 5.0, 13.0]]))
    np.testing.assert_allclose(P @ mesh.points, [[5.0, 5.0, 10.0]], atol=1e-5)
    with pytest.raises(InputError, match="measured point 2"):
        surface_interpolation(mesh, np.array([[5.0, 5.0, 10.0], [5.0, 5.0, 30.0]]))

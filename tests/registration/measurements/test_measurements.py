import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.measured import PointPairs, SurfacePoints
from physgnn.registration.measurements.places import surface_interpolation
from physgnn.registration.measurements.points import measured_pairs
from physgnn.registration.measurements.surfaces import MeasuredSurface


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


def test_a_surface_is_seen_along_its_normal_only() -> None:
    mesh = block_mesh(4, side=40.0)
    rng = np.random.default_rng(0)
    flat = rng.uniform(12, 28, (30, 2))
    surface = SurfacePoints(np.column_stack([flat, np.full(30, 43.0)]))
    measured = MeasuredSurface(mesh, mesh.point_set("fixed"), surface)
    seen = measured.observe(np.zeros_like(mesh.points))
    np.testing.assert_allclose(seen.missing, 3.0, atol=1e-4)
    slide, lift = np.zeros((2, *mesh.points.shape))
    slide[:, 0], lift[:, 2] = 2.0, 2.0
    np.testing.assert_allclose(seen.of(slide), 0.0, atol=1e-6)
    np.testing.assert_allclose(seen.of(lift), 2.0, atol=1e-6)
    np.testing.assert_allclose(measured.observe(lift).missing, 1.0, atol=1e-4)
    np.testing.assert_allclose(measured.observe(slide).missing, 3.0, atol=1e-4)


def test_pairs_are_seen_in_all_components() -> None:
    mesh = block_mesh(3)
    source = np.array([[5.0, 5.0, 10.0], [2.0, 3.0, 10.0], [7.0, 3.0, 10.0]])
    pairs = PointPairs(source, source + np.array([1.0, 2.0, 3.0]))
    seen = measured_pairs(mesh, pairs).observe(np.ones_like(mesh.points))
    np.testing.assert_allclose(seen.missing, np.tile([0.0, 1.0, 2.0], (3, 1)))

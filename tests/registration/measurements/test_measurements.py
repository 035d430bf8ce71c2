from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry import boundary_faces, boundary_surface
from physgnn.geometry.measured import (
    Landmarks,
    PointPairs,
    SurfacePoints,
    WholeSurface,
)
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import NeoHookean
from physgnn.mechanics.body import Body
from physgnn.mechanics.resection import remove_region
from physgnn.registration.measurements.places import (
    exposed_faces,
    surface_interpolation,
)
from physgnn.registration.measurements.points import measured_landmarks, measured_pairs
from physgnn.registration.measurements.surfaces import (
    MeasuredSurface,
    MeasuredWholeSurface,
)


def body_of(mesh: TetMesh) -> Body:
    return Body(mesh, {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(3000.0, 0.45)})


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
    seen = measured_pairs(body_of(mesh), pairs).observe(np.ones_like(mesh.points))
    np.testing.assert_allclose(seen.missing, np.tile([0.0, 1.0, 2.0], (3, 1)))


def test_every_kind_says_how_far_the_exposed_part_sank() -> None:
    """A block held by all but its top: out of it is up."""
    mesh = block_mesh(4, side=40.0)
    fixed = np.flatnonzero(mesh.points[:, 2] < 40.0)
    mesh = mesh.with_point_sets(fixed=fixed)
    body, n = body_of(mesh), 30
    flat = np.random.default_rng(0).uniform(12, 28, (n, 2))
    top, deep = (np.column_stack([flat, np.full(n, z)]) for z in (40.0, 25.0))
    down = np.array([1.0, 0.0, -3.0])
    for kind, see, source in (
        (PointPairs, measured_pairs, top),
        (Landmarks, measured_landmarks, deep),
    ):
        seen = see(body, kind(source, source + down))  # type: ignore[operator]
        assert seen.sunk_mm == pytest.approx(3.0, abs=1e-6)
    surface = MeasuredSurface(mesh, fixed, SurfacePoints(top + down))
    assert surface.sunk_mm == pytest.approx(3.0, abs=1e-3)


def test_landmarks_are_interpolated_within_their_cells() -> None:
    """Linear fields are exact there, which a place on the surface would not be."""
    mesh = block_mesh(3, jitter=0.15)
    inside = np.random.default_rng(0).uniform(0.5, 9.5, (30, 3))
    field = mesh.points @ np.array([[1.0, 2, 0], [0, 1, 3], [2, 0, 1]]) + 1.0
    seen = measured_landmarks(body_of(mesh), Landmarks(inside, inside)).observe(field)
    wanted = inside @ np.array([[1.0, 2, 0], [0, 1, 3], [2, 0, 1]]) + 1.0
    np.testing.assert_allclose(seen.missing, -wanted, atol=1e-9)
    np.testing.assert_allclose(seen.places.sum(axis=1), 1.0)


def test_a_landmark_outside_of_the_head_is_named() -> None:
    source = np.array([[5.0, 5.0, 5.0], [5.0, 5.0, 40.0], [5.0, 5.0, 11.0]])
    landmarks = Landmarks(source, source, ("vessel", "falx tip", "rim"))
    with pytest.raises(InputError, match=r"outside of it: 'falx tip' \(30\.0 mm\)\)"):
        measured_landmarks(body_of(block_mesh(3)), landmarks)


def whole_block(n: int, lift: float) -> WholeSurface:
    outer = boundary_surface(block_mesh(n, side=40.0))
    points = outer.points + lift * (outer.points[:, 2:] == 40.0) * [0, 0, 1]
    used, faces = np.unique(outer.faces, return_inverse=True)
    return WholeSurface(points[used], faces.reshape(-1, 3).astype(np.int64))


def test_a_whole_surface_is_matched_both_ways() -> None:
    mesh = block_mesh(4, side=40.0)
    whole = whole_block(5, 2.0)
    measured = MeasuredWholeSurface(mesh, whole)
    seen = measured.observe(np.zeros_like(mesh.points))
    n = len(whole.points)
    assert len(seen.missing) == n + len(np.unique(boundary_faces(mesh)))
    for away, points in (
        (seen.missing[:n, 0], whole.points),
        (seen.missing[n:, 0], measured.points[n:]),
    ):
        x, y, z = points.T
        within = (x > 5) & (x < 35) & (y > 5) & (y < 35)
        np.testing.assert_allclose(away[within & (z > 39)], 2.0, atol=0.06)
        np.testing.assert_allclose(away[within & (z < 1)], 0.0, atol=0.06)
    lift = np.zeros_like(mesh.points)
    lift[:, 2] = 1.0
    top = np.abs(seen.of(lift)[:, 0] - 1.0) < 1e-6
    assert top.sum() > 10


def test_which_points_of_a_surface_count_does_not_depend_on_where_they_lie() -> None:
    points = np.random.default_rng(0).normal(size=(2000, 3))
    few, again = (SurfacePoints(p).thinned(300).points for p in (points, points + 1e-6))
    np.testing.assert_allclose(few + 1e-6, again, atol=1e-12)


def test_the_wall_of_a_void_inside_is_not_seen() -> None:
    block = block_mesh(6, side=60.0)
    hollow, _ = remove_region(
        replace(block, region=_within(block, low=20.0, high=40.0).astype(np.int32)), 1
    )
    held = np.flatnonzero(hollow.points[:, 2] == 0.0)
    seen = hollow.points[exposed_faces(hollow, held)]
    assert (np.abs(seen - 30.0).max(axis=2) == 30.0).all()
    wall = np.abs(hollow.points[boundary_faces(hollow)] - 30.0).max(axis=2) < 30.0
    assert wall.all(axis=1).sum() == 6 * 2 * 2 * 2
    assert len(seen) == 5 * 2 * 6**2
    # a top that sank to just above the wall is still the top
    flat = np.random.default_rng(0).uniform(20.0, 40.0, (20, 2))
    top = SurfacePoints(np.column_stack([flat, np.full(20, 45.0)]))
    surface = MeasuredSurface(hollow, held, top)
    missing = surface.observe(np.zeros_like(hollow.points)).missing
    np.testing.assert_allclose(missing, -15.0)


def test_a_whole_surface_of_one_shell_shows_nothing_of_a_void_inside() -> None:
    block = block_mesh(6, side=60.0)
    hollow, _ = remove_region(
        replace(block, region=_within(block, low=20.0, high=40.0).astype(np.int32)), 1
    )
    outside, both = map(_whole, (block, hollow))
    rest = np.zeros_like(hollow.points)
    for surface in (outside, both):
        measured = MeasuredWholeSurface(hollow, surface)
        np.testing.assert_allclose(measured.observe(rest).missing, 0.0, atol=1e-9)
    wall = np.abs(MeasuredWholeSurface(hollow, both).points - 30.0).max(axis=1) < 20.0
    none = np.abs(MeasuredWholeSurface(hollow, outside).points - 30.0).max(axis=1)
    assert wall.any() and none.min() > 20.0


def _whole(mesh: TetMesh) -> WholeSurface:
    used, faces = np.unique(boundary_faces(mesh), return_inverse=True)
    return WholeSurface(mesh.points[used], faces.reshape(-1, 3).astype(np.int64))


def _within(mesh: TetMesh, *, low: float, high: float) -> np.ndarray:
    centres = mesh.points[mesh.cells].mean(axis=1)
    return ((centres > low) & (centres < high)).all(axis=1)

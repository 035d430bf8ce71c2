import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.image import Image, ImageGrid
from physgnn.imaging import forward_field, inverse_field, warp
from physgnn.imaging.point_displacement import displacement_at

MESH = block_mesh(4, side=40.0, jitter=0.15)
A = np.array([[0.02, 0.05, 0.0], [-0.03, 0.01, 0.04], [0.0, -0.02, 0.03]])


def test_a_linear_displacement_is_exact_inside_and_on_the_surface() -> None:
    u = MESH.points @ A.T + [1.0, -2.0, 0.5]
    random = np.random.default_rng(0)
    inside = random.uniform(0.0, 40.0, size=(200, 3))
    on_faces = inside.copy()
    on_faces[np.arange(200), random.integers(3, size=200)] = 0.0
    for points in (inside, on_faces, MESH.points):
        found = displacement_at(MESH, u, points)
        np.testing.assert_allclose(found.vectors, points @ A.T + u[0], atol=1e-9)
        assert not found.outside.any()


def test_points_and_images_move_alike() -> None:
    """Inside to rounding; outside the image takes the nearest voxel, not place."""
    u = np.random.default_rng(1).normal(size=MESH.points.shape)
    affine = np.diag([-1.0, 1.0, 1.0, 1.0])
    affine[:3, 3] = [48.0, -8.0, -8.0]
    grid = ImageGrid((57, 57, 57), affine)
    field = forward_field(MESH, u, grid)
    points = grid.to_world(np.moveaxis(np.indices(grid.shape), 0, -1).reshape(-1, 3))
    found = displacement_at(MESH, u, points)
    inside = field.inside.ravel()
    np.testing.assert_array_equal(~found.outside, inside)
    assert found.fade_mm == field.fade_mm
    vectors = field.vectors.reshape(-1, 3)
    np.testing.assert_allclose(found.vectors[inside], vectors[inside], atol=1e-9)
    np.testing.assert_allclose(found.vectors, vectors, atol=1e-6)


def test_where_a_point_goes_the_warped_image_shows_it() -> None:
    """The forward map of points and the inverse one of images are of one motion."""
    X = np.array([20.0, 22.0, 24.0])
    u = np.stack(
        [
            np.full(MESH.n_points, 3.0),
            0.1 * MESH.points[:, 2],
            0 * MESH.points[:, 0] - 2.0,
        ],
        1,
    )
    axis = np.arange(41.0)
    x = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1)
    blob = np.exp(-((x - X) ** 2).sum(-1) / (2 * 2.0**2))
    image = Image(blob, np.eye(4))
    moved = warp(image, inverse_field(MESH, u, image.grid))
    weights = np.asarray(moved.data)
    centre = (weights[..., None] * x).sum((0, 1, 2)) / weights.sum()
    found = displacement_at(MESH, u, X[None])
    np.testing.assert_allclose(X + found.vectors[0], centre, atol=0.02)


def test_outside_the_displacement_fades_with_distance() -> None:
    u = np.tile([0.0, 0.0, 5.0], (MESH.n_points, 1))  # fades over 20 mm
    points = np.array([[20.0, 20.0, z] for z in (40.0, 45.0, 50.0, 60.0, 90.0)])
    found = displacement_at(MESH, u, points)
    np.testing.assert_allclose(found.vectors[:, 2], [5.0, 3.75, 2.5, 0.0, 0.0])
    np.testing.assert_allclose(found.outside_mm, [0.0, 5.0, 10.0, 20.0, 50.0])
    with pytest.raises(InputError, match=r"do not meet .* 30 mm from the mesh"):
        displacement_at(MESH, u, np.array([[70.0, 20.0, 20.0], [0.0, 0.0, 99.0]]))

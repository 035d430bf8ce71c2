import numpy as np

from physgnn.geometry import TetMesh, boundary_surface, face_normals, vertex_normals
from physgnn.geometry.normals import area_vectors


def test_sphere_normals_point_outward_and_are_unit(sphere) -> None:  # type: ignore[no-untyped-def]
    body = sphere(10.0, (1.0, 2.0, 3.0))
    normals = vertex_normals(body)
    radial = (body.points - [1.0, 2.0, 3.0]) / 10.0
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
    assert (np.einsum("ij,ij->i", normals, radial) > 0.999).all()


def test_area_vectors_of_a_closed_surface_sum_to_zero(sphere) -> None:  # type: ignore[no-untyped-def]
    body = sphere()
    vectors = area_vectors(body.points, body.faces)
    np.testing.assert_allclose(vectors.sum(axis=0), 0.0, atol=1e-9)
    np.testing.assert_allclose(
        vectors / np.linalg.norm(vectors, axis=1, keepdims=True), face_normals(body)
    )


def test_vertex_normal_weighs_faces_alike(block: TetMesh) -> None:
    # the corner of a cube: the mean of unit normals of its faces, however many
    # triangles each has, not of areas
    body = boundary_surface(block)
    corner = np.flatnonzero((body.points == 10.0).all(axis=1))[0]
    touching = body.faces[(body.faces == corner).any(axis=1)]
    expected = np.zeros(3)
    for face in touching:
        a, b, c = body.points[face]
        normal = np.cross(b - a, c - a)
        expected += normal / np.linalg.norm(normal)
    expected /= np.linalg.norm(expected)
    np.testing.assert_allclose(vertex_normals(body)[corner], expected)


def test_points_of_no_face_have_no_normal(block: TetMesh) -> None:
    inside = np.setdiff1d(np.arange(block.n_points), boundary_surface(block).faces)
    assert len(inside) == 8
    assert not vertex_normals(boundary_surface(block))[inside].any()

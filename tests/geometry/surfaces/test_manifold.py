import numpy as np
import pytest

from physgnn.geometry.surfaces.manifold import edge_counts, orientation, pinched_points

TETRAHEDRON = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]], dtype=np.int32)


def projective_plane() -> np.ndarray:
    """The hemi-icosahedron: 6 points, closed, one side only."""
    return np.array(
        [
            [0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 1],
            [1, 2, 4], [2, 3, 5], [3, 4, 1], [4, 5, 2], [5, 1, 3],
        ],
        dtype=np.int32,
    )  # fmt: skip


def test_every_edge_of_a_closed_surface_has_two_faces() -> None:
    edges, counts = edge_counts(TETRAHEDRON)
    assert len(edges) == 6
    assert (counts == 2).all()


@pytest.mark.parametrize("turned", [[0], [1, 3], [0, 1, 2]])
def test_orientation_tells_turned_faces_apart(turned: list[int]) -> None:
    faces = TETRAHEDRON.copy()
    faces[turned] = faces[turned, ::-1]
    piece, side = orientation(faces)
    assert len(np.unique(piece)) == 1
    members = np.isin(np.arange(4), turned)
    np.testing.assert_array_equal(side == side[turned[0]], members)


def test_pieces_are_told_apart() -> None:
    piece, _ = orientation(np.concatenate([TETRAHEDRON, TETRAHEDRON + 4]))
    assert len(np.unique(piece)) == 2
    assert (piece[:4] == piece[0]).all()


def test_one_sided_surface_is_noticed() -> None:
    faces = projective_plane()
    assert (edge_counts(faces)[1] == 2).all()
    assert (orientation(faces)[1] == -1).all()


def test_pinched_points() -> None:
    assert len(pinched_points(TETRAHEDRON)) == 0
    # two tetrahedra that share point 3
    other = np.where(TETRAHEDRON == 3, 3, TETRAHEDRON + 4).astype(np.int32)
    assert pinched_points(np.concatenate([TETRAHEDRON, other])).tolist() == [3]

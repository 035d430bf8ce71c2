import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from physgnn.errors import InputError
from physgnn.geometry import Surface, edge_lengths, edges, merge, merge_points, volume

TETRAHEDRON = Surface(
    np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float),
    np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]], dtype=np.int32),
)


def test_volume_of_a_tetrahedron_is_a_sixth_and_signed() -> None:
    assert volume(TETRAHEDRON) == pytest.approx(1 / 6)
    assert volume(TETRAHEDRON.flipped()) == pytest.approx(-1 / 6)


@given(
    quaternion=st.tuples(*[st.floats(-1, 1)] * 4).filter(
        lambda q: np.linalg.norm(q) > 0.1
    ),
    shift=st.tuples(*[st.floats(-500, 500)] * 3),
    scale=st.floats(0.1, 100),
)
def test_volume_and_lengths_under_similarity(
    quaternion: tuple[float, ...], shift: tuple[float, ...], scale: float
) -> None:
    before = TETRAHEDRON.points.copy()
    moved = scale * Rotation.from_quat(quaternion).apply(before) + shift
    surface = Surface(moved, TETRAHEDRON.faces)
    assert volume(surface) == pytest.approx(scale**3 / 6, rel=1e-6)
    np.testing.assert_allclose(
        edge_lengths(surface), scale * edge_lengths(TETRAHEDRON), rtol=1e-6
    )
    np.testing.assert_array_equal(TETRAHEDRON.points, before)


def test_every_edge_comes_once() -> None:
    assert edges(TETRAHEDRON).tolist() == [
        [0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3],
    ]  # fmt: skip


def test_merging_triangle_soup_gives_the_surface_back() -> None:
    soup = TETRAHEDRON.points[TETRAHEDRON.faces].reshape(-1, 3)
    merged = merge_points(soup, np.arange(12, dtype=np.int32).reshape(-1, 3))
    assert merged.n_points == 4
    assert volume(merged) == pytest.approx(1 / 6)


def test_merged_surfaces_are_sorted_and_keep_their_volume() -> None:
    other = Surface(TETRAHEDRON.points - 5.0, TETRAHEDRON.faces)
    merged = merge([TETRAHEDRON, other])
    assert merged.n_points == 8
    order = np.lexsort(merged.points.T[::-1])
    np.testing.assert_array_equal(order, np.arange(8))
    assert volume(merged) == pytest.approx(2 / 6)


@pytest.mark.parametrize(
    ("points", "faces", "message"),
    [
        (np.empty((0, 3)), [[0, 1, 2]], "n_points ≥ 1"),
        (np.zeros((3, 2)), [[0, 1, 2]], r"\(n_points, 3\)"),
        (np.zeros((3, 3)), np.empty((0, 3)), "n_faces ≥ 1"),
        (np.zeros((3, 3)), [[0, 1, 2, 0]], r"\(n_faces, 3\)"),
        ([[0, 0, 0], [np.nan, 0, 0], [0, 1, 0]], [[0, 1, 2]], "finite .point 1"),
        ([[0, 0, 0], [1, np.inf, 0], [0, 1, 0]], [[0, 1, 2]], "finite .point 1"),
        (np.zeros((3, 3)), [[0, 1, 3]], "must index 0…2"),
        (np.zeros((3, 3)), [[0, 1, -1]], "must index 0…2"),
    ],
)
def test_refuses_what_is_no_surface(points, faces, message) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=message):
        Surface(np.array(points), np.array(faces))


def test_the_paper_surfaces(shared) -> None:  # type: ignore[no-untyped-def]
    from physgnn.io import read_surface

    brain = read_surface(shared / "paper" / "brain.stl")
    tumour = read_surface(shared / "paper" / "tumour.stl")
    assert (brain.n_points, brain.n_faces) == (672, 1340)
    assert (tumour.n_points, tumour.n_faces) == (828, 1652)
    assert volume(brain) == pytest.approx(1_469_996, abs=1)
    assert volume(tumour) == pytest.approx(5_878, abs=1)
    merged = merge([brain, tumour])
    assert len(edges(merged)) == 4488
    assert edge_lengths(merged).mean() == pytest.approx(6.0051, abs=1e-4)

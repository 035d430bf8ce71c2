import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.errors import InputError
from physgnn.geometry import (
    Surface,
    check_nested,
    check_surface,
    contains,
    merge,
    volume,
)


def test_a_good_surface_passes_as_it_is(sphere) -> None:  # type: ignore[no-untyped-def]
    body = sphere()
    checked, notes = check_surface(body, "brain")
    assert notes == []
    np.testing.assert_array_equal(checked.points, body.points)
    np.testing.assert_array_equal(checked.faces, body.faces)


def test_inverted_normals_are_flipped_and_said(sphere) -> None:  # type: ignore[no-untyped-def]
    body = sphere()
    checked, notes = check_surface(body.flipped(), "brain")
    assert notes == ["brain: normals pointed inward: flipped"]
    assert volume(checked) == pytest.approx(volume(body))


@given(seed=st.integers(0, 1000), share=st.floats(0.01, 0.99))
def test_any_mix_of_normals_is_mended(sphere, seed: int, share: float) -> None:  # type: ignore[no-untyped-def]
    body = sphere(refinements=1)
    turned = np.random.default_rng(seed).uniform(size=body.n_faces) < share
    faces = np.where(turned[:, None], body.faces[:, ::-1], body.faces)
    checked, notes = check_surface(Surface(body.points, faces), "brain")
    assert volume(checked) == pytest.approx(volume(body))
    assert bool(notes) is bool(turned.any())


def test_collapsed_faces_and_unused_points_are_dropped_and_said(sphere) -> None:  # type: ignore[no-untyped-def]
    body = sphere()
    points = np.concatenate([body.points, [[99.0, 0.0, 0.0]]])
    faces = np.concatenate([body.faces, [[0, 0, 1]]])
    checked, notes = check_surface(Surface(points, faces), "brain")
    assert checked.n_points == body.n_points
    assert checked.n_faces == body.n_faces
    assert notes == [
        "brain: 1 collapsed faces dropped",
        "brain: 1 unused points dropped",
    ]


@pytest.mark.parametrize("corners", [[0, 1, 2], [1, 2, 0], [2, 1, 0]])
def test_a_face_that_comes_twice_is_refused(sphere, corners: list[int]) -> None:  # type: ignore[no-untyped-def]
    body = sphere()
    faces = np.concatenate([body.faces, body.faces[3:4, corners]])
    with pytest.raises(InputError, match="non-manifold"):
        check_surface(Surface(body.points, faces), "brain")


# From points, faces and a number below 12 to something wrong with them, or harmless.
MUTATIONS = {
    "shifted": lambda p, f, i: (p, f + 2**32 * (np.arange(len(f)) == i)[:, None]),
    "as floats": lambda p, f, _: (p, f + 0.0),
    "twice": lambda p, f, i: (p, np.concatenate([f, f[i : i + 1]])),
    "lost": lambda p, f, i: (p, np.delete(f, i, axis=0)),
    "turned": lambda p, f, i: (p, np.concatenate([f[:i], f[i:, ::-1]])),
    "collapsed": lambda p, f, i: (p, np.concatenate([f, f[i : i + 1, [0, 0, 1]]])),
    "nan": lambda p, f, i: (np.concatenate([p[:i], np.nan * p[i:]]), f),
    "complex": lambda p, f, _: (p + 0j, f),
    "inside out": lambda p, f, _: (-p, f),
    "in other units": lambda p, f, _: (p / 1e6, f),
    "moved": lambda p, f, i: (p + 30.0 * (np.arange(len(p)) == i)[:, None], f),
    "one point more": lambda p, f, i: (np.concatenate([p, p[i : i + 1]]), f),
}


@given(
    st.lists(
        st.tuples(st.sampled_from(sorted(MUTATIONS)), st.integers(0, 11)), max_size=4
    )
)
def test_a_mutated_surface_is_refused_or_closed(sphere, steps) -> None:  # type: ignore[no-untyped-def]
    body = sphere(refinements=0)
    points, faces = body.points, body.faces.astype(np.int64)
    try:
        for name, i in steps:
            points, faces = MUTATIONS[name](points, faces, i % len(faces))
        checked, _ = check_surface(Surface(points, faces), "brain")
    except InputError as error:
        assert "\n" not in str(error)
        return
    assert volume(checked) > 0
    edge_uses = np.sort(checked.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2))
    assert (np.unique(edge_uses, axis=0, return_counts=True)[1] == 2).all()


def opened(body: Surface) -> Surface:
    return Surface(body.points, body.faces[1:])


def with_a_fin(body: Surface) -> Surface:
    a, b, _ = body.faces[0]
    points = np.concatenate([body.points, [3.0 * body.points[a]]])
    fin = [[a, b, body.n_points]]
    closed = [[b, body.n_points, a]]
    return Surface(points, np.concatenate([body.faces, fin, closed]))


def pierced(body: Surface) -> Surface:
    points = body.points.copy()
    points[points[:, 2].argmax()] = [0.0, 0.0, -14.0]
    return Surface(points, body.faces)


def with_a_flat_face(body: Surface) -> Surface:
    """Split a face at the middle of one of its edges, without the neighbour."""
    a, b, c = body.faces[0]
    points = np.concatenate([body.points, [(body.points[a] + body.points[b]) / 2]])
    d = body.n_points
    faces = [[a, b, d], [a, d, c], [d, b, c]]
    return Surface(points, np.concatenate([body.faces[1:], faces]))


def pinched(body: Surface) -> Surface:
    """The topmost point is the lowest too."""
    top, bottom = body.points[:, 2].argmax(), body.points[:, 2].argmin()
    return Surface(body.points, np.where(body.faces == top, bottom, body.faces))


FAULTS = {
    "open": (opened, r"3 open edges, the first at \(-?\d"),
    "non-manifold": (with_a_fin, r"non-manifold edges, the first at \("),
    "crossing": (pierced, r"crosses itself at \d+ pairs of faces .* near \("),
    "pinched": (pinched, r"touches itself in 1 points \(the first at \("),
    "flat": (with_a_flat_face, r"1 faces have no area .* near \("),
    "metres": (lambda s: Surface(s.points / 1e3, s.faces), "metres.*multiply.*1000"),
    "micrometres": (lambda s: Surface(s.points * 1e3, s.faces), "micrometres"),
    "pieces": (
        lambda s: merge([s, Surface(s.points + 50.0, s.faces)]),
        r"one piece \(it is 2; the smallest has 320 faces near \(",
    ),
    "nothing left": (lambda s: Surface(s.points, s.faces[:, [0, 0, 1]]), "degenerate"),
    "pillow": (
        lambda s: Surface(s.points, [s.faces[0], s.faces[0, ::-1]]),
        "encloses no volume",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_are_refused_in_one_line_that_says_where(sphere, fault: str) -> None:  # type: ignore[no-untyped-def]
    spoil, message = FAULTS[fault]
    with pytest.raises(InputError, match=message) as caught:
        check_surface(spoil(sphere()), "brain")
    assert str(caught.value).startswith("brain: ")
    assert "\n" not in str(caught.value)


def test_where_an_open_edge_is(sphere) -> None:  # type: ignore[no-untyped-def]
    body = sphere()
    corners = body.points[body.faces[0]]
    middles = [(corners[i] + corners[i - 1]) / 2 for i in range(3)]
    places = ["({:.1f}, {:.1f}, {:.1f}) mm".format(*middle) for middle in middles]
    with pytest.raises(InputError) as caught:
        check_surface(opened(body), "brain")
    assert any(place in str(caught.value) for place in places)


@given(st.tuples(*[st.floats(-20, 20)] * 3))
def test_contains_agrees_with_the_sphere(sphere, point) -> None:  # type: ignore[no-untyped-def]
    distance = float(np.linalg.norm(point))
    if not 9.5 < distance < 10.5:
        assert contains(sphere(10.0), np.array(point)) is (distance < 10.0)


def test_nested_tumours_pass(sphere) -> None:  # type: ignore[no-untyped-def]
    check_nested(sphere(20.0), [])
    check_nested(sphere(20.0), [sphere(4.0, (8, 0, 0)), sphere(4.0, (-8, 0, 0))])


def test_tumours_where_they_must_not_be(sphere) -> None:  # type: ignore[no-untyped-def]
    brain, tumour = sphere(20.0), sphere(4.0)
    for tumours, message in (
        ([sphere(4.0, (19, 0, 0))], r"tumour must not cross the brain's .* near \(1"),
        ([sphere(4.0, (40, 0, 0))], r"tumour must lie inside .* at \(.*aligned"),
        ([sphere(30.0)], "swap the two files"),
        ([tumour, sphere(4.0, (3, 0, 0))], r"tumour 2 must not cross tumour 1 .* near"),
        ([tumour, sphere(2.0)], "tumour 2 and tumour 1 must be apart"),
        ([sphere(2.0), tumour], "tumour 2 and tumour 1 must be apart"),
    ):
        with pytest.raises(InputError, match=message):
            check_nested(brain, tumours)


def test_the_paper_surfaces_pass(shared) -> None:  # type: ignore[no-untyped-def]
    from physgnn.io import read_surface

    surfaces = [
        read_surface(shared / "paper" / f"{n}.stl") for n in ("brain", "tumour")
    ]
    for surface in surfaces:
        assert check_surface(surface, "brain")[1] == []
    check_nested(surfaces[0], surfaces[1:])

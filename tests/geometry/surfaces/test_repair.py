"""Faults that clustering leaves are cut out; what is sound stays as it is."""

import builtins
import importlib.util

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry import Surface, check_surface, volume
from physgnn.geometry.surfaces import repair
from physgnn.geometry.surfaces.repair import repaired


@pytest.fixture(autouse=True)
def without_meshfix(request, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    """As an installation without extras, where a test does not ask for them."""
    if "meshfix" not in request.fixturenames:
        monkeypatch.setattr(repair, "meshfix_available", lambda: False)


@pytest.fixture
def meshfix() -> None:
    if importlib.util.find_spec("pymeshfix") is None:
        pytest.skip("needs the meshfix extra")


def without(surface: Surface, faces: list[int]) -> Surface:
    return Surface(surface.points, np.delete(surface.faces, faces, axis=0))


def faulty(ball: Surface, fault: str) -> Surface:
    """A ball with one fault."""
    points, faces = ball.points, ball.faces
    if fault == "hole":
        return without(ball, [0, 1, 7])
    if fault == "fin":  # a third face at an edge, to a point outside
        tip = 1.2 * points[faces[3]].mean(axis=0)
        fin = [*faces[3][:2], len(points)]
        return Surface(np.vstack([points, tip]), np.vstack([faces, fin]))
    if fault == "twice":
        return Surface(points, np.vstack([faces, faces[5:6, ::-1]]))
    if fault == "crossing":  # a point pulled out through the other side
        moved = points.copy()
        moved[10] *= -1.3
        return Surface(moved, faces)
    assert fault == "speck"
    small = 0.05 * points + [0, 0, 40.0]
    return Surface(np.vstack([points, small]), np.vstack([faces, faces + len(points)]))


@pytest.mark.parametrize("fault", ["hole", "fin", "twice", "crossing", "speck"])
def test_one_fault_is_repaired_and_the_volume_kept(fault: str, sphere) -> None:  # type: ignore[no-untyped-def]
    ball = sphere(20.0)
    broken = faulty(ball, fault)
    with pytest.raises(InputError):
        check_surface(broken, "ball")
    mended = repaired(broken, "ball")
    assert check_surface(mended, "ball")[1] == []
    assert volume(mended) == pytest.approx(volume(ball), rel=0.03)


def test_what_is_sound_keeps_its_points_and_faces(sphere) -> None:  # type: ignore[no-untyped-def]
    ball = sphere(20.0)
    mended = repaired(ball, "ball")
    np.testing.assert_array_equal(mended.points, ball.points)
    np.testing.assert_array_equal(mended.faces, ball.faces)


def everted(ball: Surface) -> Surface:
    """Points in any order: nothing of it is a surface."""
    points = ball.points[np.random.default_rng(0).permutation(ball.n_points)]
    return Surface(points, ball.faces)


def test_what_cannot_be_repaired_is_refused_by_its_first_fault(sphere) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match="ball: the surface crosses itself"):
        repaired(everted(sphere(20.0)), "ball")


@pytest.mark.usefixtures("meshfix")
def test_meshfix_tries_what_is_left_over(sphere, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    ball = sphere(20.0)
    broken = faulty(ball, "hole")
    monkeypatch.setattr(repair, "_without_faults", lambda *_: None)
    mended = repaired(broken, "ball")
    assert volume(mended) == pytest.approx(volume(ball), rel=0.03)


def test_nothing_imports_meshfix_where_it_is_not_needed(sphere, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    real = builtins.__import__

    def refusing(name: str, *rest, **more):  # type: ignore[no-untyped-def]
        assert name != "pymeshfix"
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", refusing)
    repaired(faulty(sphere(20.0), "fin"), "ball")

"""What a surface must be before it is meshed: repaired where safe, else refused.

Every refusal says where, in mm, so that the place can be found in a viewer.
"""

from collections.abc import Sequence

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.normals import area_vectors
from physgnn.geometry.plausibility import check_millimetres
from physgnn.geometry.surface import Surface, volume
from physgnn.geometry.surfaces.intersections import crossing_faces
from physgnn.geometry.surfaces.manifold import edge_counts, orientation, pinched_points

# An area below this fraction of the longest edge squared is rounding.
FLAT = 1e-10


def check_surface(surface: Surface, name: str) -> tuple[Surface, list[str]]:
    """Return a closed, outward surface and what was repaired.

    Unused points and collapsed faces are dropped and normals made outward.

    Parameters
    ----------
    surface : Surface
        As read.
    name : str
        What messages call it, such as ``"brain"``.

    Returns
    -------
    Surface, list of str
        The repaired surface, and one line for everything that was repaired.

    Raises
    ------
    InputError
        If it is in other units, has faces without area, open or non-manifold
        edges, several pieces or no volume, or touches or crosses itself.
    """
    notes: list[str] = []
    surface = _without_leftovers(surface, name, notes)
    check_millimetres(surface.points, name)
    _check_areas(surface, name)
    _check_edges(surface, name)
    surface = _oriented(surface, name, notes)
    _check_contacts(surface, name)
    return surface, notes


def check_nested(
    brain: Surface, tumours: Sequence[Surface], names: Sequence[str] = ()
) -> None:
    """Check that tumours lie wholly inside the brain and apart from each other.

    Parameters
    ----------
    brain : Surface
        As `check_surface` returns it, mm.
    tumours : sequence of Surface
        Each as `check_surface` returns it, mm.
    names : sequence of str, optional
        What messages call the surfaces inside the brain; by default tumours.

    Raises
    ------
    InputError
        If one crosses the brain's surface or another's, or lies outside of it or
        inside another.
    """
    single = len(tumours) == 1
    if not names:
        names = ["tumour" if single else f"tumour {i + 1}" for i in range(len(tumours))]
    for i, tumour in enumerate(tumours):
        _check_apart(brain, tumour, "the brain's surface", names[i])
        if not contains(brain, tumour.points[0]):
            swapped = contains(tumour, brain.points[0])
            remedy = "swap the two files" if swapped else "check that they are aligned"
            raise InputError(
                f"{names[i]} must lie inside the brain (its point at "
                f"{_text(tumour.points[0])} is outside): {remedy}"
            )
        for j, other in enumerate(tumours[:i]):
            _check_apart(other, tumour, names[j], names[i])
            if contains(other, tumour.points[0]) or contains(tumour, other.points[0]):
                raise InputError(
                    f"{names[i]} and {names[j]} must be apart (one holds the other, "
                    f"near {_text(tumour.points[0])}): merge them into one surface"
                )


def contains(surface: Surface, point: FloatArray) -> bool:
    """Whether a closed outward surface encloses a point.

    The solid angle all faces subtend is 4π inside and 0 outside (van Oosterom and
    Strackee, IEEE Trans. Biomed. Eng. 30, 1983).

    Parameters
    ----------
    surface : Surface
        Closed triangles, counter-clockwise seen from outside; mm.
    point : (3,) array
        mm.

    Returns
    -------
    bool
        True inside.
    """
    a, b, c = np.moveaxis((surface.points - point)[surface.faces], 1, 0)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    triple = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = [np.einsum("ij,ij->i", u, v) for u, v in ((a, b), (b, c), (c, a))]
    below = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
    return bool(2.0 * np.arctan2(triple, below).sum() > 2.0 * np.pi)


def _without_leftovers(surface: Surface, name: str, notes: list[str]) -> Surface:
    """Drop faces that name a point twice, then points of no face."""
    a, b, c = surface.faces.T
    faces_with_area = surface.faces[(a != b) & (b != c) & (c != a)]
    if len(faces_with_area) == 0:
        raise InputError(f"{name}: every face is degenerate: export the surface again")
    if len(faces_with_area) < surface.n_faces:
        notes.append(
            f"{name}: {surface.n_faces - len(faces_with_area)} collapsed faces dropped"
        )
    used, faces = np.unique(faces_with_area, return_inverse=True)
    if len(used) < surface.n_points:
        notes.append(f"{name}: {surface.n_points - len(used)} unused points dropped")
    return Surface(surface.points[used], faces.reshape(-1, 3).astype(np.int32))


def _check_areas(surface: Surface, name: str) -> None:
    corners = surface.points[surface.faces]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    area = np.linalg.norm(area_vectors(surface.points, surface.faces), axis=1)
    flat = np.flatnonzero(area <= FLAT * longest**2)
    if len(flat):
        raise InputError(
            f"{name}: {len(flat)} faces have no area (first: face {flat[0]} near "
            f"{_place(surface, flat[:1])}): remesh or repair the surface"
        )


def _check_edges(surface: Surface, name: str) -> None:
    """Every edge must belong to exactly two faces."""
    edges, count = edge_counts(surface.faces)
    for wrong, what, remedy in (
        (count == 1, "open", "close the hole"),
        (count > 2, "non-manifold", "keep two faces at each"),
    ):
        if wrong.any():
            middle = surface.points[edges[wrong][0]].mean(axis=0)
            raise InputError(
                f"{name}: the surface must be closed ({wrong.sum()} {what} edges, the "
                f"first at {_text(middle)}): {remedy}, for instance with MeshLab or "
                "pymeshfix"
            )


def _oriented(surface: Surface, name: str, notes: list[str]) -> Surface:
    """Turn faces so that neighbours agree and all face outward."""
    piece, side = orientation(surface.faces)
    _check_one_piece(surface, name, piece)
    if (side < 0).any():
        raise InputError(f"{name}: the surface has one side only, like a Klein bottle")
    rare = side == (0 if 2 * side.sum() > len(side) else 1)
    if rare.any():
        notes.append(f"{name}: {rare.sum()} faces disagreed with the rest: turned over")
        faces = np.where(rare[:, None], surface.faces[:, ::-1], surface.faces)
        surface = Surface(surface.points, faces)
    enclosed = volume(surface)
    size = float(np.ptp(surface.points, axis=0).max())
    if abs(enclosed) <= FLAT * size**3:
        raise InputError(f"{name}: the surface encloses no volume: export it again")
    if enclosed < 0:
        notes.append(f"{name}: normals pointed inward: flipped")
        surface = surface.flipped()
    return surface


def _check_one_piece(surface: Surface, name: str, piece: IntArray) -> None:
    pieces, sizes = np.unique(piece, return_counts=True)
    if len(pieces) > 1:
        smallest = np.flatnonzero(piece == pieces[sizes.argmin()])
        raise InputError(
            f"{name}: the surface must be one piece (it is {len(pieces)}; the smallest "
            f"has {sizes.min()} faces near {_place(surface, smallest)}): remove specks "
            "and cavities, or pass each tumour as a file of its own"
        )


def _check_contacts(surface: Surface, name: str) -> None:
    """No two sheets may touch in a point or cross."""
    pinched = pinched_points(surface.faces)
    if len(pinched):
        raise InputError(
            f"{name}: the surface touches itself in {len(pinched)} points (the first "
            f"at {_text(surface.points[pinched[0]])}): pull the two sheets apart"
        )
    crossings = crossing_faces(surface)
    if len(crossings):
        a, b = crossings[0]
        raise InputError(
            f"{name}: the surface crosses itself at {len(crossings)} pairs of faces "
            f"(first: faces {a} and {b} near {_place(surface, crossings[0])}): "
            "repair it, for instance with MeshLab or pymeshfix"
        )


def _check_apart(a: Surface, b: Surface, name_a: str, name_b: str) -> None:
    both = Surface(
        np.concatenate([a.points, b.points]),
        np.concatenate([a.faces, b.faces + a.n_points]),
    )
    pairs = crossing_faces(both)
    mixed = pairs[(pairs[:, 0] < a.n_faces) & (pairs[:, 1] >= a.n_faces)]
    if len(mixed):
        raise InputError(
            f"{name_b} must not cross {name_a} ({len(mixed)} pairs of faces cross, the "
            f"first near {_place(both, mixed[0])}): shrink or move it"
        )


def _place(surface: Surface, faces: IntArray) -> str:
    return _text(surface.points[surface.faces[faces]].mean(axis=(0, 1)))


def _text(point: FloatArray) -> str:
    x, y, z = point
    return f"({x:.1f}, {y:.1f}, {z:.1f}) mm"

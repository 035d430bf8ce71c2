"""What is seen of a body's surface, and how it moved there."""

from typing import Protocol, runtime_checkable

import numpy as np
from scipy.spatial import cKDTree

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store
from physgnn.geometry.boundary import boundary_faces, boundary_points
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement

SEEN_MM = 30.0  # the radius of the surface that is seen
# Each point goes to the mean of so many measured ones: noise is halved and more.
NEAREST = 6
DRAWN = 2000  # points of a measured surface in training


@runtime_checkable
class FromKnownDisplacement(Protocol):
    """What gives a body's displacement from that of some of its points."""

    def displacement_from(self, known: PrescribedDisplacement) -> FloatArray:
        """Return the displacement of all points, (n_points, 3), mm."""


def seen_points(body: Body, centre: FloatArray) -> IntArray:
    """Return the points of the surface within 30 mm of a place that are not fixed.

    Parameters
    ----------
    body : Body
        Which.
    centre : (3,) array
        mm; the point of the surface nearest to it is the middle of what is seen.
    """
    free = np.setdiff1d(boundary_points(body.mesh), body.fixed)
    places = body.mesh.points[free]
    middle = places[np.linalg.norm(places - centre, axis=1).argmin()]
    seen: IntArray = free[np.linalg.norm(places - middle, axis=1) <= SEEN_MM]
    return seen


def seen_about(body: Body, load_case: LoadCase) -> IntArray:
    """Return the points that are seen about the middle of a load."""
    return seen_points(body, body.mesh.points[load_case.nodes].mean(axis=0))


def known_displacement(
    store: Store, path: int, level: int, *, matched: bool
) -> PrescribedDisplacement:
    """Return what is seen of a sample's displacement.

    Parameters
    ----------
    store : Store
        Holds it.
    path, level : int
        The sample.
    matched : bool
        Only where the surface lies is seen, not which point is which.
    """
    seen = seen_about(store.body, store.load_case(path, level))
    moved = store.displacement(path)[level].astype(np.float64)
    if not matched:
        return PrescribedDisplacement(seen, moved[seen])
    faces = boundary_faces(store.mesh)
    faces = faces[np.isin(faces, seen).all(axis=1)]
    if not len(faces):
        return PrescribedDisplacement(seen, moved[seen])
    rng = np.random.default_rng([path, level])
    corners = faces[rng.choice(len(faces), DRAWN)]
    weights = rng.dirichlet(np.ones(3), DRAWN)
    drawn = np.einsum("ni,nij->nj", weights, (store.mesh.points + moved)[corners])
    return matched_displacement(store.body, np.unique(faces), drawn)


def matched_displacement(
    body: Body, seen: IntArray, measured: FloatArray
) -> PrescribedDisplacement:
    """Move each seen point to the measured ones nearest to it.

    Parameters
    ----------
    body : Body
        Which.
    seen : integer array
        Its points.
    measured : (n, 3) array
        Where the surface lies, mm.
    """
    seen = np.asarray(seen, dtype=np.int64)
    rest = body.mesh.points[seen]
    count = min(NEAREST, len(measured))
    _, nearest = cKDTree(measured).query(rest, k=np.arange(1, count + 1))
    return PrescribedDisplacement(seen, measured[nearest].mean(axis=1) - rest)

"""Where material points went: all three components of their displacement count."""

import numpy as np
from scipy.sparse import csr_array

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.measured import Landmarks, PointPairs
from physgnn.mechanics.body import Body
from physgnn.registration.measurements.observation import Observation
from physgnn.registration.measurements.places import (
    cell_interpolation,
    nearest_places,
    opening_direction,
    surface_interpolation,
)

HEAD_MM = 300.0  # no place of a head is farther from another


# Places before a shift that lie farther than this from the cortex at rest, in the
# median, while those after it lie less than half as far, are taken for exchanged.
EXCHANGED_MM = 2.0


class MeasuredPoints:
    """Pairs of points at places that a sparse matrix interpolates.

    Their `exchanged_mm` is how far the places before lie from the cortex at rest, in
    the median, where they look like those after it; else 0.
    """

    def __init__(
        self, kind: str, body: Body, pairs: PointPairs, places: csr_array
    ) -> None:
        self.exchanged_mm = 0.0
        self.kind, self.labels = kind, pairs.labels
        self.points, self.measured = pairs.source, pairs.target
        self.moved = pairs.displacement
        self._places = places
        away = np.linalg.norm(places @ body.mesh.points - pairs.source, axis=1)
        self.distance_mm = float(np.median(away))
        outward = self.moved @ opening_direction(body.mesh, body.fixed)
        self.sunk_mm = -float(np.median(outward))
        self._axes = np.tile(np.eye(3), (len(self.moved), 1, 1))

    def observe(self, displacement: FloatArray) -> Observation:
        """Compare the displacement of each point with the measured one."""
        missing: FloatArray = self.moved - self._places @ displacement
        return Observation(self._places, self._axes, missing)


def measured_pairs(body: Body, pairs: PointPairs) -> MeasuredPoints:
    """Return pairs on the surface, each at the place of the surface nearest to it.

    Raises
    ------
    InputError
        If one is more than 10 mm from the surface, or moved farther than a head is
        long.
    """
    places = surface_interpolation(body.mesh, pairs.source)
    check_within_head(pairs)
    found = MeasuredPoints("pairs", body, pairs, places)
    faces = boundary_faces(body.mesh)
    _, nearest = nearest_places(body.mesh.points, faces, pairs.target)
    after = float(np.median(np.linalg.norm(pairs.target - nearest, axis=1)))
    if found.distance_mm > EXCHANGED_MM and after < found.distance_mm / 2:
        found.exchanged_mm = found.distance_mm
    return found


def measured_landmarks(body: Body, landmarks: Landmarks) -> MeasuredPoints:
    """Return landmarks inside, each in its cell.

    Raises
    ------
    InputError
        If some are outside of the brain, or moved farther than a head is long.
    """
    places = cell_interpolation(body.mesh, landmarks.source, landmarks.labels)
    check_within_head(landmarks)
    return MeasuredPoints("landmarks", body, landmarks, places)


def check_within_head(pairs: PointPairs) -> None:
    """Raise InputError if a place has moved farther than a head is long."""
    moved = np.linalg.norm(pairs.displacement, axis=1)
    far = np.flatnonzero(moved > HEAD_MM)
    if len(far):
        raise InputError(
            f"{len(far)} of {len(moved)} measured places, "
            f"'{pairs.labels[far[0]]}' first, lie "
            f"{moved[far[0]]:.0f} mm from where they were (a head is {HEAD_MM:g} mm "
            "long): leave them out, or give the transform of the tracker's space "
            "(--initial-transform)"
        )

"""Where material points went: all three components of their displacement count."""

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array

from physgnn.arrays import FloatArray
from physgnn.geometry.measured import Landmarks, PointPairs
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.registration.measurements.observation import Observation
from physgnn.registration.measurements.places import (
    cell_interpolation,
    opening_direction,
    surface_interpolation,
)


class MeasuredPoints:
    """Pairs of points at places that a sparse matrix interpolates."""

    def __init__(
        self, kind: str, body: Body, pairs: PointPairs, places: csr_array
    ) -> None:
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
        If one is more than 10 mm from the surface.
    """
    return _measured("pairs", body, pairs, surface_interpolation)


def measured_landmarks(body: Body, landmarks: Landmarks) -> MeasuredPoints:
    """Return landmarks inside, each in its cell.

    Raises
    ------
    InputError
        If some are outside of the brain.
    """

    def places(mesh: TetMesh, points: FloatArray) -> csr_array:
        return cell_interpolation(mesh, points, landmarks.labels)

    return _measured("landmarks", body, landmarks, places)


def _measured(
    kind: str,
    body: Body,
    pairs: PointPairs,
    places: Callable[[TetMesh, FloatArray], csr_array],
) -> MeasuredPoints:
    return MeasuredPoints(kind, body, pairs, places(body.mesh, pairs.source))

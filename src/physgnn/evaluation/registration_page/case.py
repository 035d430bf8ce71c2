"""What a page about a registration is made of."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from physgnn.arrays import FloatArray
from physgnn.evaluation.registration_page.places import MeasuredPlace
from physgnn.geometry.image import Image
from physgnn.geometry.tetmesh import TetMesh
from physgnn.prediction.prediction import Prediction


@dataclass(frozen=True, eq=False)
class RegisteredCase:
    """A registration and what it came from.

    Attributes
    ----------
    mesh : TetMesh
        The rest state.
    prediction : Prediction
        Displacement, bounds, status with its reasons.
    deviation_mm : (n_points,) array
        Standard deviation of each point's displacement.
    covariance_mm2 : (n_points, 3, 3) array
        Of each point's error.
    misfit_mm, held_out_mm : float
        Root mean squares, see `physgnn.registration.result.Registration`.
    places : tuple of MeasuredPlace
        What was measured, with the distances before and after.
    noise_mm : float
        Stated standard deviation of a measured coordinate.
    image : Image, optional
        The scan at rest.
    facts : mapping of str to str
        Where the numbers come from.
    wrong_mm : float
        Beyond this a position is called wrong.
    """

    mesh: TetMesh
    prediction: Prediction
    deviation_mm: FloatArray
    covariance_mm2: FloatArray
    misfit_mm: float
    held_out_mm: float
    places: tuple[MeasuredPlace, ...]
    noise_mm: float
    image: Image | None = None
    facts: Mapping[str, str] = field(default_factory=dict)
    wrong_mm: float = 2.0

    @property
    def displacement(self) -> FloatArray:
        """u, (n_points, 3), mm."""
        return self.prediction.displacement

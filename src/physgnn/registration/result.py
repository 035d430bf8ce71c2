"""What a registration found."""

from dataclasses import dataclass

from physgnn.arrays import FloatArray
from physgnn.prediction.measured_evidence import BoneFit, RigidOffset
from physgnn.prediction.prediction import Prediction
from physgnn.registration.misfits import Misfit


@dataclass(frozen=True, eq=False)
class Registration:
    """A whole displacement field from what was measured.

    Attributes
    ----------
    prediction : Prediction
        Displacement, error estimate, status with its reasons, and time.
    deviation_mm : (n_points,) array
        Standard deviation of each point's displacement (root of the trace).
    covariance_mm2 : (n_points, 3, 3) array
        Of each point's error; its root trace is `deviation_mm`.
    forces : (n_points, 3) array
        The nodal forces that explain the measurement, N; not unique. Under them the
        body lies so without any growth.
    misfit_mm : float
        Root mean square distance between measured and registered places that are no
        outliers; of a measured surface, across it.
    held_out_mm : float
        The same for places that were left out, each predicted from the others.
    misfits : tuple of Misfit
        Of every place, with its weight; outliers among them. Points of the bone come
        last; `misfit_mm` and `held_out_mm` are of the others.
    offset : RigidOffset
        Of the navigation; part of the displacement only if it is not `corrected`.
    bone : BoneFit or None
        How well points of the bone agree on that offset; None if there were none, so
        that nothing checked the navigation but what may have moved with the brain.
    left_out : tuple of str
        Pairs that were listed and have no place at one end.
    """

    prediction: Prediction
    deviation_mm: FloatArray
    covariance_mm2: FloatArray
    forces: FloatArray
    misfit_mm: float
    held_out_mm: float
    misfits: tuple[Misfit, ...]
    offset: RigidOffset
    bone: BoneFit | None = None
    left_out: tuple[str, ...] = ()

    @property
    def outliers(self) -> tuple[Misfit, ...]:
        """Places that the rest contradicts, the farthest first."""
        found = [one for one in self.misfits if one.is_outlier]
        return tuple(sorted(found, key=lambda one: -one.distance_mm))

    @property
    def navigation(self) -> str:
        """What is known of the navigation, in a line."""
        told = "not checked against bone" if self.bone is None else str(self.bone)
        return f"rigid offset {self.offset}; {told}"

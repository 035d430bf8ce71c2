"""How well a registration meets what was measured: the evidence for its status."""

import numpy as np
from scipy.stats import chi2

from physgnn.arrays import FloatArray
from physgnn.geometry.measured import farthest_points
from physgnn.prediction.evidence import SAME_PLACE_MM, MeasurementFit
from physgnn.registration.gaussian import Posterior
from physgnn.registration.measurement import MeasuredPairs, Measurement

# The stated noise may be too small by this factor before a misfit counts against it:
# a tracker's noise is known no better.
NOISE_KNOWN_WITHIN = 1.5
# The points of a surface are thinned to those farthest from each other, which are the
# noisier ones: their variance was up to 2.1 times that of all in simulated shifts
# (benchmarks/registration_statuses.py).
VARIANCE_BY_KIND = {"pairs": 1.0, "surface": 2.0}


def fit_of(
    measurement: Measurement, displacement: FloatArray, posterior: Posterior
) -> MeasurementFit:
    """Return how well a displacement meets a measurement.

    Parameters
    ----------
    measurement : Measurement
        What was measured.
    displacement : (n_points, 3) array
        Of the registered body, mm.
    posterior : Posterior
        Of the last step that led there.
    """
    places = measurement.points[
        farthest_points(measurement.points, spacing=SAME_PLACE_MM)
    ]
    missing = measurement.observe(displacement).missing
    elastic = float((missing**2).sum()) / max(posterior.freedom, 1.0)
    translation, misfit = (
        best_translation(measurement.moved)
        if isinstance(measurement, MeasuredPairs)
        else (0.0, np.inf)
    )
    allowed = NOISE_KNOWN_WITHIN**2 * VARIANCE_BY_KIND[measurement.kind]
    ratio = posterior.misfit_ratio
    return MeasurementFit(
        n_places=len(places),
        spread_mm=second_spread(places),
        distance_mm=measurement.distance_mm,
        translation_mm=translation,
        translation_misfit=misfit / max(elastic, np.finfo(float).tiny),
        misfit_ratio=ratio,
        chance=float(chi2.sf(posterior.freedom * ratio / allowed, posterior.freedom)),
    )


def second_spread(places: FloatArray) -> float:
    """Return the standard deviation of places along their second principal axis, mm."""
    away = places - places.mean(axis=0)
    sizes = np.linalg.svd(away, compute_uv=False)
    return float(sizes[1] / np.sqrt(len(places))) if len(sizes) > 1 else 0.0


def best_translation(moved: FloatArray) -> tuple[float, float]:
    """Return the length of the translation nearest to displacements, and its misfit.

    The misfit is the sum of squares that is left, over its degrees of freedom, mm².
    """
    mean = moved.mean(axis=0)
    left = float(((moved - mean) ** 2).sum()) / max(moved.size - 3, 1)
    return float(np.linalg.norm(mean)), left

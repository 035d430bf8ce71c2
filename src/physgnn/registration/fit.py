"""How well a registration meets what was measured: the evidence for its status."""

import numpy as np
from scipy.stats import chi2

from physgnn.arrays import FloatArray
from physgnn.geometry.measured import farthest_points
from physgnn.prediction.evidence import SAME_PLACE_MM, Fit
from physgnn.registration.gaussian import Posterior
from physgnn.registration.measurement import Measurement

# The stated noise may be too small by this factor before a misfit counts against it:
# a tracker's noise is known no better.
NOISE_KNOWN_WITHIN = 1.5
# The points of a surface are thinned to those farthest from each other, which are the
# noisier ones: their variance is up to twice that of all (0.7 mm of noise in a plane).
VARIANCE_BY_KIND = {"pairs": 1.0, "surface": 2.0}
MAX_STEPS, SHORT_MM = 10, 0.01  # of the search for a translation


def fit_of(
    measurement: Measurement, displacement: FloatArray, posterior: Posterior
) -> Fit:
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
    translation, misfit = best_translation(measurement, len(displacement))
    elastic = float((measurement.observe(displacement).missing ** 2).sum())
    elastic /= max(posterior.freedom, 1.0)
    allowed = NOISE_KNOWN_WITHIN**2 * VARIANCE_BY_KIND[measurement.kind]
    ratio = posterior.misfit_ratio
    return Fit(
        n_places=len(places),
        spread_mm=second_spread(places),
        distance_mm=measurement.distance_mm,
        translation_mm=float(np.linalg.norm(translation)),
        translation_misfit=misfit / max(elastic, np.finfo(float).tiny),
        misfit_ratio=ratio,
        chance=float(chi2.sf(posterior.freedom * ratio / allowed, posterior.freedom)),
    )


def second_spread(places: FloatArray) -> float:
    """Return the standard deviation of places along their second principal axis, mm."""
    away = places - places.mean(axis=0)
    sizes = np.linalg.svd(away, compute_uv=False)
    return float(sizes[1] / np.sqrt(len(places))) if len(sizes) > 1 else 0.0


def best_translation(
    measurement: Measurement, n_points: int
) -> tuple[FloatArray, float]:
    """Return the translation that meets a measurement best, and what it leaves.

    Returns
    -------
    (3,) array
        mm.
    float
        Sum of squares that is left, over its degrees of freedom, mm².
    """
    t = np.zeros(3)
    for _ in range(MAX_STEPS):
        seen = measurement.observe(np.tile(t, (n_points, 1)))
        axes, missing = seen.axes.reshape(-1, 3), seen.missing.ravel()
        step = np.linalg.lstsq(axes, missing, rcond=None)[0]
        t = t + step
        if np.linalg.norm(step) < SHORT_MM:
            break
    left = measurement.observe(np.tile(t, (n_points, 1))).missing
    return t, float((left**2).sum()) / max(left.size - 3, 1)

"""A rigid offset of the navigation: whether there is one, and how large.

Beforehand an offset has a standard deviation of 2 mm along each axis and of 2° about
each: an assumption, of the size that registrations of trackers are off by. Two models
are compared by the probability that each gives to the data, loads alone and loads with
an offset; a ratio of e³ is strong evidence (Kass & Raftery, "Bayes factors", Journal of
the American Statistical Association 90, 1995, 773–795).
"""

from dataclasses import dataclass, replace

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.registration.inference.gaussian import Posterior, log_evidence
from physgnn.registration.inference.heavy_tails import (
    RobustFit,
    chosen_prior,
    reweighted,
)
from physgnn.registration.inference.rows import MeasuredRows, Modes

TRANSLATION_MM, ROTATION_DEG = 2.0, 2.0
PRIOR = np.repeat([TRANSLATION_MM, np.deg2rad(ROTATION_DEG)], 3) ** 2


@dataclass(frozen=True, eq=False)
class RigidOffset:
    """How far the navigation seems to be off.

    Attributes
    ----------
    translation_mm : (3,) array
        Along x, y and z, of the middle of what was measured.
    rotation_deg : (3,) array
        About x, y and z through that middle.
    deviation_mm, deviation_deg : (3,) arrays
        Standard deviations of these, given the data.
    centre_mm : (3,) array
        The middle.
    log_ratio : float
        Logarithm of how much more probable the data are with an offset.
    change_mm : float
        How far, at most, the displacement of a point is another with an offset.
    corrected : bool
        Whether the displacement is the one with an offset.
    """

    translation_mm: FloatArray
    rotation_deg: FloatArray
    deviation_mm: FloatArray
    deviation_deg: FloatArray
    centre_mm: FloatArray
    log_ratio: float
    change_mm: float
    corrected: bool

    @property
    def length_mm(self) -> float:
        """Length of the translation."""
        return float(np.linalg.norm(self.translation_mm))

    @property
    def turn_deg(self) -> float:
        """Angle of the rotation."""
        return float(np.linalg.norm(self.rotation_deg))


def offset_between(
    rows: MeasuredRows, modes: Modes, weights: FloatArray
) -> tuple[float, RobustFit, RobustFit]:
    """Compare loads alone with loads and an offset.

    Parameters
    ----------
    rows : MeasuredRows
        With the columns of the offset at the end.
    modes : Modes
        With the offset among what is known.
    weights : (n,) array
        Of each place.

    Returns
    -------
    log_ratio : float
        Of the probabilities of the data, positive for an offset.
    without, with_offset : RobustFit
        Of each model.
    """
    n = len(modes.family)
    alone = MeasuredRows(rows.A[:, :n], rows.d, rows.noise, rows.blocks)
    models = (
        (alone, replace(modes, known=np.empty(0))),
        (rows, modes),
    )
    evidence, fits = [], []
    root = np.sqrt(rows.spread(weights))
    for seen, these in models:
        prior = chosen_prior(seen, these, weights)
        A, d = seen.A * root[:, None], seen.d * root
        evidence.append(log_evidence(A, d, prior, 1.0))
        fits.append(reweighted(seen, prior, weights, 1))
    return evidence[1] - evidence[0], fits[0], fits[1]


def offset_of(
    posterior: Posterior,
    centre: FloatArray,
    *,
    log_ratio: float,
    change_mm: float,
    corrected: bool,
) -> RigidOffset:
    """Return the offset that the last six coefficients are."""
    mean = posterior.mean[-6:]
    deviation = np.sqrt(np.maximum(posterior.covariance.diagonal()[-6:], 0.0))
    return RigidOffset(
        translation_mm=mean[:3],
        rotation_deg=np.rad2deg(mean[3:]),
        deviation_mm=deviation[:3],
        deviation_deg=np.rad2deg(deviation[3:]),
        centre_mm=centre,
        log_ratio=log_ratio,
        change_mm=change_mm,
        corrected=corrected,
    )

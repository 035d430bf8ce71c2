"""A rigid offset of the navigation: whether there is one, and how large.

Beforehand there is none in 95 of 100 operations. In four there is one of the size that
registrations of trackers are off by, with a standard deviation of 2 mm along each axis
and 2° about each; in one the tracker was misplaced, 8 mm and 4°. All are assumptions.
The probability that each of these models gives to the data turns them into the
probability of an offset given the data (Kass & Raftery, "Bayes factors", Journal of the
American Statistical Association 90, 1995, 773–795).

The models know neither the tissue nor the line along which the skull holds, and an
offset explains a part of that. So only a third of the
logarithm of the evidence counts (a power of the likelihood: Miller & Dunson, "Robust
Bayesian inference via coarsening", Journal of the American Statistical Association 114,
2019, 1113–1125).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import logsumexp

from physgnn.arrays import FloatArray
from physgnn.prediction.measured_evidence import RigidOffset
from physgnn.registration.inference.gaussian import (
    Posterior,
    condition_blocks,
    log_evidence,
)
from physgnn.registration.inference.heavy_tails import (
    RobustFit,
    chosen_prior,
    reweighted,
)
from physgnn.registration.inference.rows import MeasuredRows, Modes


@dataclass(frozen=True)
class Hypothesis:
    """How far a navigation may be off.

    Attributes
    ----------
    probability : float
        Beforehand.
    translation_mm, rotation_deg : float
        Standard deviation along and about each axis; zero if there is no offset.
    """

    probability: float
    translation_mm: float = 0.0
    rotation_deg: float = 0.0

    @property
    def variances(self) -> FloatArray:
        """Of the six coefficients, mm² and rad²; none if there is no offset."""
        if not self.translation_mm:
            return np.empty(0)
        each = [self.translation_mm, np.deg2rad(self.rotation_deg)]
        return np.repeat(each, 3) ** 2


NONE, USUAL = Hypothesis(0.95), Hypothesis(0.04, 2.0, 2.0)
MISPLACED = Hypothesis(0.01, 8.0, 4.0)
HYPOTHESES = (NONE, USUAL, MISPLACED)
POWER = 1 / 3  # of the likelihood


@dataclass(frozen=True, eq=False)
class OffsetPrior:
    """What is known of an offset that a search corrects.

    Attributes
    ----------
    variances : (6,) array
        Of independent coefficients.
    axes : (6, 6) array
        What each coefficient is in translation (mm) and rotation (radians), a column
        each.
    """

    variances: FloatArray
    axes: FloatArray


UNKNOWN = OffsetPrior(USUAL.variances, np.eye(6))


@dataclass(frozen=True, eq=False)
class OffsetEvidence:
    """Loads alone against loads with an offset.

    Attributes
    ----------
    probabilities : (k,) array
        Of each of `HYPOTHESES`, given the data.
    fits : tuple of RobustFit
        With each; the coefficients of the offset are the last six.
    log_ratio : float
        Of the probabilities of the data, positive for an offset, times `POWER`.
    """

    probabilities: FloatArray
    fits: tuple[RobustFit, ...]
    log_ratio: float

    @property
    def likely(self) -> RobustFit:
        """The fit with the more probable of the offsets."""
        return self.fits[1 + int(self.probabilities[1:].argmax())]


def compared(rows: MeasuredRows, modes: Modes, weights: FloatArray) -> OffsetEvidence:
    """Compare loads alone with loads and an offset, small or large.

    Parameters
    ----------
    rows : MeasuredRows
        With the columns of the offset at the end.
    modes : Modes
        Without the offset.
    weights : (n,) array
        Of each place.
    """
    n = len(modes.family)
    alone = MeasuredRows(rows.A[:, :n], rows.d, rows.noise, rows.blocks)
    found = [
        _fitted(
            rows if len(one.variances) else alone,
            replace(modes, known=one.variances),
            weights,
        )
        for one in HYPOTHESES
    ]
    evidence = POWER * np.array([value for value, _ in found])
    fits = tuple(fit for _, fit in found)
    return OffsetEvidence(probabilities_of(evidence), fits, log_ratio_of(evidence))


def probabilities_of(evidence: FloatArray) -> FloatArray:
    """Return the probability of each of `HYPOTHESES` from the data's logarithms."""
    after = evidence + np.log([one.probability for one in HYPOTHESES])
    found: FloatArray = np.exp(after - logsumexp(after))
    return found


def log_ratio_of(evidence: FloatArray) -> float:
    """Return how much more probable the data are with an offset, as a logarithm."""
    before = np.log([one.probability for one in HYPOTHESES[1:]])
    ratio = logsumexp(evidence[1:] + before) - logsumexp(before) - evidence[0]
    return float(ratio)


def _fitted(
    rows: MeasuredRows, modes: Modes, weights: FloatArray
) -> tuple[float, RobustFit]:
    """Return the logarithm of the data's probability, and the fit."""
    root = np.sqrt(rows.spread(weights))
    prior = chosen_prior(rows, modes, weights)
    evidence = log_evidence(rows.A * root[:, None], rows.d * root, prior, 1.0)
    return evidence, reweighted(rows, prior, weights, 1)


def unknown_of(rows: MeasuredRows, prior: FloatArray, weights: FloatArray) -> float:
    """Return how far a misplaced tracker may be off, unseen by the data, mm.

    Beforehand it is off by `MISPLACED`; with the data, the standard deviation of its
    translation is this in the direction that they tell least about.

    Parameters
    ----------
    rows : MeasuredRows
        With the columns of the offset at the end.
    prior : (n,) array
        Variance of each load's coefficient.
    weights : (n,) array
        Of each place.
    """
    root = np.sqrt(rows.spread(weights))
    variances = np.concatenate([prior, MISPLACED.variances])
    weighted = rows.A * root[:, None], rows.d * root
    found = condition_blocks(*weighted, variances, 1.0, rows.blocks)
    translation = found.covariance[-6:-3, -6:-3]
    return float(np.sqrt(max(np.linalg.eigvalsh(translation)[-1], 0.0)))


def offset_of(
    posterior: Posterior,
    centre: FloatArray,
    comparison: OffsetEvidence,
    *,
    change_mm: float,
    unknown_mm: float,
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
        log_ratio=comparison.log_ratio,
        probability=float(comparison.probabilities[1:].sum()),
        change_mm=change_mm,
        unknown_mm=unknown_mm,
        corrected=corrected,
    )

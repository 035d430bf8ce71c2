"""Noise with heavy tails: a place that does not fit loses its weight.

The error of a place with k components is taken for Student's t with ν degrees of
freedom and the stated noise for its scale. The most probable coefficients follow from
weighted least squares, again and again, with weights

    w = (ν + k) / (ν + |e|²/σ²),

|e|² the squared error expected of the place given the data: that of the most probable
fit and its variance (expectation–maximisation; Lange, Little & Taylor, "Robust
statistical modeling using the t distribution", Journal of the American Statistical
Association 84, 1989, 881–896; ν = 4 is theirs). So as not to begin at a fit that the
bad places have bent, the search starts with a noise of eight times the stated one,
which is then halved (graduated non-convexity: Blake & Zisserman, *Visual
Reconstruction*, 1987); a second search starts with the stated noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.registration.inference.gaussian import (
    Blocks,
    Posterior,
    choose_variances,
    condition_blocks,
)
from physgnn.registration.inference.rows import MeasuredRows, Modes

NU = 4.0
# Two starts, of which the more probable fit is taken: the first is blind to a shift of
# a few places as small as eight times the noise, the second may be bent by bad places.
STARTS = ((8.0, 4.0, 2.0, 1.0), (1.0,))
ITERATIONS, LAST_ITERATIONS = 3, 12
# Below this weight a place is an outlier: three components 4.4 times as far off as the
# stated noise, or one 3.6 times, of which the chance is 3e-4.
OUTLIER_WEIGHT = 0.3


@dataclass(frozen=True, eq=False)
class RobustFit:
    """A posterior, and how far each place was trusted.

    Attributes
    ----------
    posterior : Posterior
        Of the weighted rows.
    weights : (n,) array
        Of each place, about 1 for one that fits.
    misfit : (m,) array
        Of every datum, over its stated noise.
    """

    posterior: Posterior
    weights: FloatArray
    misfit: FloatArray

    @property
    def outliers(self) -> BoolArray:
        """Places that the rest contradicts, (n,)."""
        return self.weights < OUTLIER_WEIGHT


def robust_start(rows: MeasuredRows, modes: Modes) -> tuple[FloatArray, RobustFit]:
    """Choose the prior variances and the weights together, from rest.

    Returns
    -------
    prior : (r,) array
        Variance of each coefficient, those of `modes.known` at the end.
    fit : RobustFit
        With these.
    """
    found = [_descended(rows, modes, scales) for scales in STARTS]
    return max(found, key=lambda one: log_density(rows, *one))


def _descended(
    rows: MeasuredRows, modes: Modes, scales: Sequence[float]
) -> tuple[FloatArray, RobustFit]:
    """Return prior and fit after these scales of the noise, one after the other."""
    weights = np.ones(rows.n_places)
    for scale in scales:
        prior = chosen_prior(rows, modes, weights, scale)
        last = scale == scales[-1]
        count = LAST_ITERATIONS if last else ITERATIONS
        fit = reweighted(rows, prior, weights, count, scale=scale)
        weights = fit.weights
    prior = chosen_prior(rows, modes, weights, 1.0)
    return prior, reweighted(rows, prior, weights, LAST_ITERATIONS)


def log_density(rows: MeasuredRows, prior: FloatArray, fit: RobustFit) -> float:
    """Return the logarithm of the data's probability, by Laplace's approximation.

    The coefficients are integrated out about the fit; what is the same for every fit is
    left out.

    Parameters
    ----------
    rows : MeasuredRows
        Everything measured.
    prior : (r,) array
        Variance of each coefficient.
    fit : RobustFit
        With this prior.
    """
    total, first = 0.0, 0
    for n, k in rows.blocks:
        part = fit.misfit[first : first + n * k].reshape(n, k)
        square = (part**2).sum(axis=1)
        total -= float(((NU + k) / 2 * np.log1p(square / NU)).sum())
        first += n * k
    B = rows.A * np.sqrt(rows.spread(fit.weights))[:, None] * np.sqrt(prior)
    smaller = B @ B.T if len(B) < len(prior) else B.T @ B
    _, log_det = np.linalg.slogdet(np.eye(len(smaller)) + smaller)
    away = float((fit.posterior.mean**2 / np.maximum(prior, 1e-300)).sum())
    return total - (away + float(log_det)) / 2


def chosen_prior(
    rows: MeasuredRows, modes: Modes, weights: FloatArray, scale: float = 1.0
) -> FloatArray:
    """Return the variance of every coefficient that suits the weighted rows."""
    root = np.sqrt(rows.spread(weights)) / scale
    A, d = rows.A * root[:, None], rows.d * root
    n_chosen = len(modes.family)
    chosen = choose_variances(
        A[:, :n_chosen],
        d,
        modes.family,
        1.0,
        typical=max(rows.typical_mm(weights), modes.least_mm),
        known=A[:, n_chosen:] * np.sqrt(modes.known),
        most=modes.most,
    )
    prior: FloatArray = np.concatenate([chosen, modes.known])
    return prior


def reweighted(
    rows: MeasuredRows,
    prior: FloatArray,
    weights: FloatArray,
    count: int,
    *,
    scale: float = 1.0,
) -> RobustFit:
    """Return the fit after so many rounds of weighting.

    Parameters
    ----------
    rows : MeasuredRows
        Everything measured.
    prior : (r,) array
        Variance of each coefficient.
    weights : (n,) array
        To begin with.
    count : int
        Rounds, at least one.
    scale : float
        Times the stated noise.
    """
    for _ in range(count):
        root = np.sqrt(rows.spread(weights)) / scale
        posterior = condition_blocks(
            rows.A * root[:, None], rows.d * root, prior, 1.0, rows.blocks
        )
        misfit = rows.d - rows.A @ posterior.mean
        expected = misfit**2 / scale**2 + posterior.leverage / rows.spread(weights)
        weights = student_weights(expected, rows.blocks)
    return RobustFit(posterior, weights, misfit)


def student_weights(square: FloatArray, blocks: Blocks) -> FloatArray:
    """Return the weight of each place from the expected squares of its data.

    Parameters
    ----------
    square : (m,) array
        Of errors over the noise.
    blocks : tuple of (n, k)
        So many places of so many data each.
    """
    found, first = [], 0
    for n, k in blocks:
        sums = square[first : first + n * k].reshape(n, k).sum(axis=1)
        found.append((NU + k) / (NU + sums))
        first += n * k
    weights: FloatArray = np.concatenate(found)
    return weights

"""Bounds on the error of a registration: the posterior, widened after simulations.

The posterior does not know that materials, the line along which the skull holds and the
loads may be others. Simulated shifts say by which factor errors go beyond it
(`FACTORS`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.prediction.prediction import ErrorBound
from physgnn.registration.tangent_response import Fields

N_DRAWS = 100
NEGLIGIBLE = 1e-3  # probability of an alternative that no quantile sees


@dataclass(frozen=True)
class Factors:
    """How far errors go beyond the posterior, at the 90th percentile of simulations."""

    of_mean: float
    of_largest: float


# By how the skull holds, what was measured ("several" if more than one kind), and how
# an offset was corrected, whose uncertainty widens the posterior by itself: "no",
# "estimated" from the brain alone, or "by bone" (of another 210 registrations). Of
# 340 registrations of 21 simulated shifts, measured well and badly: the quantile of
# error over the posterior's bound that conformal prediction takes for 90 % (Vovk,
# Gammerman & Shafer, *Algorithmic Learning in a Random World*, 2005), as
# benchmarks/registration_factors.py prints it. Where the skull is fixed those of pairs,
# landmarks, surfaces and several are wider by the same quantile of 457 registrations of
# shifts, sag and resections on 2000 points, benchmarks/registration_peers.py: there
# these first factors held in 86 % (mean) and 82 % (largest).
FACTORS: Mapping[tuple[str, str, str], Factors] = {
    ("fixed", "pairs", "no"): Factors(1.29, 1.22),
    ("fixed", "pairs", "estimated"): Factors(1.64, 1.40),
    ("fixed", "pairs", "by bone"): Factors(1.28, 1.24),
    ("fixed", "landmarks", "no"): Factors(1.34, 1.32),
    ("fixed", "landmarks", "estimated"): Factors(1.41, 1.24),
    ("fixed", "landmarks", "by bone"): Factors(1.21, 1.32),
    ("fixed", "surface", "no"): Factors(0.78, 0.74),
    ("fixed", "surface", "estimated"): Factors(1.26, 1.05),
    ("fixed", "surface", "by bone"): Factors(0.90, 0.82),
    ("fixed", "whole surface", "no"): Factors(1.44, 1.75),
    ("fixed", "whole surface", "estimated"): Factors(1.43, 1.26),
    ("fixed", "whole surface", "by bone"): Factors(1.38, 1.33),
    ("fixed", "several", "no"): Factors(1.58, 1.99),
    ("fixed", "several", "estimated"): Factors(2.00, 1.71),
    ("fixed", "several", "by bone"): Factors(1.50, 1.86),
    ("sliding", "pairs", "no"): Factors(1.55, 2.27),
    ("sliding", "pairs", "estimated"): Factors(1.21, 1.69),
    ("sliding", "pairs", "by bone"): Factors(1.67, 2.42),
    ("sliding", "landmarks", "no"): Factors(2.59, 2.36),
    ("sliding", "landmarks", "estimated"): Factors(1.88, 1.97),
    ("sliding", "landmarks", "by bone"): Factors(2.66, 2.32),
    ("sliding", "surface", "no"): Factors(0.81, 0.83),
    ("sliding", "surface", "estimated"): Factors(1.55, 1.23),
    ("sliding", "surface", "by bone"): Factors(0.93, 0.95),
    ("sliding", "whole surface", "no"): Factors(2.03, 1.80),
    ("sliding", "whole surface", "estimated"): Factors(1.34, 1.53),
    ("sliding", "whole surface", "by bone"): Factors(2.42, 1.97),
    ("sliding", "several", "no"): Factors(2.09, 2.27),
    ("sliding", "several", "estimated"): Factors(1.92, 1.92),
    ("sliding", "several", "by bone"): Factors(1.93, 2.33),
}


def factors_of(kinds: Sequence[str], *, skull: str, corrected: str) -> Factors:
    """Return how far errors go beyond the posterior.

    Parameters
    ----------
    kinds : sequence of str
        What was measured.
    skull : str
        How it holds, a row of `physgnn.registration.skull.SUPPORTS`.
    corrected : str
        How an offset of the navigation was: "no", "estimated" or "by bone".
    """
    kind = kinds[0] if len(set(kinds)) == 1 else "several"
    return FACTORS[skull, kind, corrected]


@dataclass(frozen=True, eq=False)
class Alternative:
    """One of the posteriors that the error may be of.

    Attributes
    ----------
    probability : float
        Of it, given the data.
    change : (r,) array
        Its mean minus the registered coefficients.
    covariance : (r, r) array
        Of the coefficients.
    """

    probability: float
    change: FloatArray
    covariance: FloatArray


@dataclass(frozen=True, eq=False)
class ErrorLengths:
    """Lengths of errors, drawn.

    Attributes
    ----------
    of_points : (n, n_points) array
        mm.
    weights : (n,) array
        Of each draw; they add up to 1.
    """

    of_points: FloatArray
    weights: FloatArray

    @property
    def deviation_mm(self) -> FloatArray:
        """Root mean square of each point, (n_points,)."""
        deviation: FloatArray = np.sqrt(self.weights @ self.of_points**2)
        return deviation


def mixed_covariance(alternatives: Sequence[Alternative]) -> FloatArray:
    """Return the second moment of the coefficients' error, (r, r)."""
    parts = [
        one.probability * (one.covariance + np.outer(one.change, one.change))
        for one in alternatives
    ]
    total: FloatArray = np.sum(parts, axis=0)
    return total


def error_lengths(
    alternatives: Sequence[Alternative], response: Fields, seed: int
) -> ErrorLengths:
    """Return the lengths of errors drawn from posteriors.

    Parameters
    ----------
    alternatives : sequence of Alternative
        Their probabilities add up to 1.
    response : (r, n_points, 3) array
        What each load mode does, mm.
    seed : int
        Of the draws.
    """
    told = [one for one in alternatives if one.probability > NEGLIGIBLE]
    lengths = [_drawn(one, response, seed) for one in told]
    weights = np.repeat([one.probability for one in told], N_DRAWS)
    return ErrorLengths(np.concatenate(lengths), weights / weights.sum())


def _drawn(one: Alternative, response: Fields, seed: int) -> FloatArray:
    variances, axes = np.linalg.eigh(one.covariance)
    z = np.random.default_rng(seed).standard_normal((N_DRAWS, len(response)))
    # The symmetric root: eigenvectors alone turn when variances are nearly equal.
    root = (axes * np.sqrt(np.maximum(variances, 0.0))) @ axes.T
    errors = np.tensordot((one.change + z @ root).astype(np.float32), response, 1)
    lengths: FloatArray = np.linalg.norm(errors, axis=2).astype(np.float64)
    return lengths


def estimate_of(lengths: ErrorLengths, coverage: float, factors: Factors) -> ErrorBound:
    """Return bounds on the mean and the largest error.

    Parameters
    ----------
    lengths : ErrorLengths
        Of errors drawn.
    coverage : float
        Probability that a bound shall hold.
    factors : Factors
        How far errors go beyond what was drawn.
    """
    drawn = lengths.of_points
    mean = factors.of_mean * _quantile(drawn.mean(axis=1), lengths.weights, coverage)
    most = factors.of_largest * _quantile(drawn.max(axis=1), lengths.weights, coverage)
    return ErrorBound(min(mean, most), most, coverage)


def _quantile(values: FloatArray, weights: FloatArray, coverage: float) -> float:
    """Return the quantile of weighted values, linear between them."""
    order = np.argsort(values)
    middles = np.cumsum(weights[order]) - weights[order] / 2
    return float(np.interp(coverage, middles, values[order]))

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
from physgnn.registration.inference.gaussian import Posterior
from physgnn.registration.tangent_response import Fields

N_DRAWS = 100


@dataclass(frozen=True)
class Factors:
    """How far errors go beyond the posterior, at the 90th percentile of simulations."""

    of_mean: float
    of_largest: float


# By what was measured ("several" for points and anything else), and whether an offset
# was corrected, whose uncertainty widens the posterior by itself. Of 22 simulated
# shifts (benchmarks/registration_bounds.py --cases 11 --first-seed 600, and 700),
# measured 15 ways each where the skull holds its points: the quantile of error over
# the posterior's bound that conformal prediction takes for 90 %, 0.9 (1 + 1/22) (Vovk,
# Gammerman & Shafer, *Algorithmic Learning in a Random World*, 2005).
FACTORS: Mapping[tuple[str, bool], Factors] = {
    ("pairs", False): Factors(1.35, 1.7),
    ("pairs", True): Factors(1.3, 1.3),
    ("landmarks", False): Factors(1.15, 1.1),
    ("landmarks", True): Factors(1.4, 1.45),
    ("surface", False): Factors(0.7, 0.8),
    ("surface", True): Factors(1.0, 0.85),
    ("several", False): Factors(1.3, 1.55),
    ("several", True): Factors(1.75, 1.55),
}
SURFACES = ("surface", "whole surface")


def error_lengths(posterior: Posterior, response: Fields, seed: int) -> FloatArray:
    """Return the lengths of errors drawn from the posterior, (n_draws, n_points).

    Parameters
    ----------
    posterior : Posterior
        Of the coefficients of load modes; those of an offset may follow.
    response : (r, n_points, 3) array
        What each load mode does, mm.
    seed : int
        Of the draws.
    """
    r = len(response)
    variances, axes = np.linalg.eigh(posterior.covariance[:r, :r])
    z = np.random.default_rng(seed).standard_normal((N_DRAWS, r))
    # The symmetric root: eigenvectors alone turn when variances are nearly equal.
    root = (axes * np.sqrt(np.maximum(variances, 0.0))) @ axes.T
    errors = np.tensordot((z @ root).astype(np.float32), response, 1)
    lengths: FloatArray = np.linalg.norm(errors, axis=2).astype(np.float64)
    return lengths


def estimate_of(
    lengths: FloatArray, coverage: float, kinds: Sequence[str], *, corrected: bool
) -> ErrorBound:
    """Return bounds on the mean and the largest error.

    Parameters
    ----------
    lengths : (n_draws, n_points) array
        Of errors drawn.
    coverage : float
        Probability that a bound shall hold.
    kinds : sequence of str
        What was measured.
    corrected : bool
        Whether an offset of the navigation was.
    """
    factors = FACTORS[_row(kinds), corrected]
    mean = factors.of_mean * float(np.quantile(lengths.mean(axis=1), coverage))
    largest = factors.of_largest * float(np.quantile(lengths.max(axis=1), coverage))
    return ErrorBound(min(mean, largest), largest, coverage)


def _row(kinds: Sequence[str]) -> str:
    if all(kind in SURFACES for kind in kinds):
        return "surface"
    return kinds[0] if len(set(kinds)) == 1 else "several"

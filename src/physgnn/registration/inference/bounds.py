"""Bounds on the error of a registration: the posterior, widened after simulations.

The posterior does not know that materials, the line along which the skull holds and the
loads may be others. Simulated shifts say by which factor errors go beyond it
(`FACTORS`).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.prediction.prediction import ErrorBound
from physgnn.registration.inference.gaussian import Posterior
from physgnn.registration.tangent_response import Fields

N_DRAWS = 100
# Of the mean and of the largest error, by whether points or surfaces alone were
# measured and how the skull holds: errors over their bounds at the 90th percentile of
# simulated shifts.
FACTORS: Mapping[tuple[str, str], tuple[float, float]] = {
    ("points", "fixed"): (1.0, 1.0),
    ("points", "sliding"): (1.0, 1.0),
    ("surfaces", "fixed"): (1.0, 1.0),
    ("surfaces", "sliding"): (1.0, 1.0),
}
POINT_KINDS = ("pairs", "landmarks")


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
    lengths: FloatArray, coverage: float, kinds: Sequence[str], skull: str
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
    skull : str
        How the skull holds.
    """
    what = "points" if any(kind in POINT_KINDS for kind in kinds) else "surfaces"
    of_mean, of_largest = FACTORS[what, skull]
    mean = of_mean * float(np.quantile(lengths.mean(axis=1), coverage))
    largest = of_largest * float(np.quantile(lengths.max(axis=1), coverage))
    return ErrorBound(min(mean, largest), largest, coverage)

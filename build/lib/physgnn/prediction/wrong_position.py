"""How probable it is that a predicted position is wrong by more than so many mm.

The error e of a position is taken for Gaussian with mean zero and a covariance C that
is known for each point. Then |e|² is a sum of chi-square variables of one degree of
freedom, weighted by the eigenvalues of C (Mathai & Provost, *Quadratic Forms in Random
Variables*, 1992, chapter 4). Its distribution follows from e = C^½ ρ ω: the length ρ of
a standard normal vector and its direction ω are independent, ρ² is chi-square of three
degrees of freedom, ω uniform on the sphere (Muirhead, *Aspects of Multivariate
Statistical Theory*, 1982, theorem 1.5.6). So

    P(|e| > t) = E_ω[ Q(t² / (ωᵀ C ω)) ],    Q(x) = P(ρ² > x),

a mean over an eighth of the sphere in the axes of C. Unlike an expansion, it needs no
care where eigenvalues are equal or zero.
"""

import numpy as np
from scipy.special import erfc

from physgnn.arrays import FloatArray
from physgnn.errors import InputError

# Of the mean over directions: within 1e-6 wherever t is a tenth of the largest
# deviation or more.
N_HEIGHTS, N_ANGLES = 64, 24
CHUNK = 4096  # points at a time, for memory


def probability_beyond(covariance: FloatArray, threshold_mm: float) -> FloatArray:
    """Return the probability that a Gaussian error is longer than a threshold.

    Parameters
    ----------
    covariance : (n, 3, 3) array
        Of each point's error, mm².
    threshold_mm : float
        t, > 0.

    Returns
    -------
    (n,) array
        In [0, 1]; 0 where the covariance is zero.

    Raises
    ------
    InputError
        If t is not > 0, or a matrix is no covariance.
    """
    if not 0 < threshold_mm < np.inf:
        raise InputError(f"wrong_mm must be > 0 (got {threshold_mm})")
    variances = np.linalg.eigvalsh(_checked(covariance))
    variances = np.maximum(variances, 0.0)
    directions, weights = _eighth_of_sphere()
    found = np.empty(len(variances))
    for start in range(0, len(variances), CHUNK):
        part = slice(start, start + CHUNK)
        along = variances[part] @ directions.T
        with np.errstate(divide="ignore"):
            ratio = threshold_mm**2 / along
        found[part] = _beyond(ratio) @ weights
    return np.clip(found, 0.0, 1.0)


def isotropic(deviation_mm: FloatArray) -> FloatArray:
    """Return the covariances (n, 3, 3) of errors that are alike in all directions.

    Parameters
    ----------
    deviation_mm : (n,) array
        Root mean square length of each error, the root of the trace.
    """
    third = np.asarray(deviation_mm, dtype=np.float64) ** 2 / 3.0
    found: FloatArray = third[:, None, None] * np.eye(3)
    return found


def _checked(covariance: FloatArray) -> FloatArray:
    C = np.asarray(covariance, dtype=np.float64)
    if C.ndim != 3 or C.shape[1:] != (3, 3) or not np.isfinite(C).all():
        raise InputError(f"covariances must be finite, (n, 3, 3) (got {C.shape})")
    size = np.abs(C).max(axis=(1, 2), initial=0.0)
    asymmetry = np.abs(C - np.swapaxes(C, 1, 2)).max(axis=(1, 2), initial=0.0)
    least = np.linalg.eigvalsh(C)[:, 0]
    # files hold single precision
    wrong = (asymmetry > 1e-5 * size) | (least < -1e-4 * size)
    if wrong.any():
        i = int(np.flatnonzero(wrong)[0])
        raise InputError(f"no covariance at point {i} (it has a negative variance)")
    return C


def _beyond(x: FloatArray) -> FloatArray:
    """Return the chance that chi-square of three degrees of freedom exceeds x."""
    half = np.minimum(x, 1e4) / 2.0
    root = np.sqrt(half)
    chance: FloatArray = erfc(root) + 2.0 / np.sqrt(np.pi) * root * np.exp(-half)
    return chance


def _eighth_of_sphere() -> tuple[FloatArray, FloatArray]:
    """Return squared components of directions, the last along the axis, and weights.

    Gauss–Legendre in the height; the midpoint rule in the angle, which is periodic.
    """
    nodes, weights = np.polynomial.legendre.leggauss(N_HEIGHTS)
    height = (nodes + 1.0) / 2.0
    angle = (np.arange(N_ANGLES) + 0.5) * np.pi / (2 * N_ANGLES)
    across = 1.0 - height**2
    squares = np.stack(
        [
            np.outer(across, np.cos(angle) ** 2),
            np.outer(across, np.sin(angle) ** 2),
            np.outer(height**2, np.ones(N_ANGLES)),
        ],
        axis=-1,
    )
    share = np.repeat(weights / 2.0 / N_ANGLES, N_ANGLES)
    return squares.reshape(-1, 3), share

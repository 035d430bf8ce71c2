"""The covariance of each point's error, from the posterior of the coefficients."""

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray


def point_covariance(
    covariance: FloatArray, response: NDArray[np.float32], deviation_mm: FloatArray
) -> FloatArray:
    """Return R C Rᵀ of every point, scaled to its deviation, mm².

    The posterior gives the shape, R C Rᵀ with R the responses of a point to each mode.
    The deviation has been widened by what the posterior does not know, and gives the
    size: the root of the trace.

    Parameters
    ----------
    covariance : (r, r) array
        C, of the error of the modes' coefficients.
    response : (r, n_points, 3) array
        What each mode does, mm.
    deviation_mm : (n_points,) array
        Standard deviation of each point's displacement.

    Returns
    -------
    (n_points, 3, 3) array
    """
    r, n, _ = response.shape
    variances, axes = np.linalg.eigh(covariance)
    root = (axes * np.sqrt(np.maximum(variances, 0.0))).T.astype(np.float32)
    errors = (root @ response.reshape(r, -1)).reshape(r, n, 3)
    shape: FloatArray = np.einsum("rni,rnj->nij", errors, errors).astype(np.float64)
    trace = np.trace(shape, axis1=1, axis2=2)
    scale = deviation_mm**2 / np.where(trace > 0, trace, 1.0)
    found: FloatArray = scale[:, None, None] * shape
    return found

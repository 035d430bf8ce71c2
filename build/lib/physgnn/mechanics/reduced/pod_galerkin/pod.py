"""Proper orthogonal decomposition: the fields that best span some others."""

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray


def leading_modes(fields: NDArray[np.floating], n_modes: int) -> FloatArray:
    """Return orthonormal modes, those that carry most of the fields first.

    By the method of snapshots (Sirovich 1987): eigenvectors of the small matrix of the
    fields' inner products.

    Parameters
    ----------
    fields : (n_fields, n_points, 3) array
        What to span.
    n_modes : int
        How many; those that the fields don't span are zero.

    Returns
    -------
    (n_modes, n_points, 3) array
    """
    flat = np.asarray(fields, dtype=np.float64).reshape(len(fields), -1)
    values, vectors = np.linalg.eigh(flat @ flat.T)
    values, vectors = values[::-1][:n_modes], vectors[:, ::-1][:, :n_modes]
    spanning = values > 1e-12 * max(float(values[0]), np.finfo(float).tiny)
    modes = np.zeros((n_modes, flat.shape[1]))
    modes[: spanning.sum()] = (
        vectors[:, spanning] / np.sqrt(values[spanning])
    ).T @ flat
    return modes.reshape(n_modes, *fields.shape[1:])

"""Norms and products of the unknowns, the same for any number of threads."""

import numpy as np

from physgnn.arrays import FloatArray


def largest_norm(d: FloatArray) -> float:
    """Largest Euclidean norm over points, mm."""
    return float(np.sqrt((d.reshape(-1, 3) ** 2).sum(axis=1).max()))


def norm(r: FloatArray) -> float:
    """Euclidean norm, the same for any number of threads."""
    return float(np.sqrt(dot(r, r)))


def dot(a: FloatArray, b: FloatArray) -> float:
    """Scalar product, the same for any number of threads."""
    # Not a @ b: BLAS would start threads for it, and its sums depend on their number.
    return float(np.einsum("i,i->", a, b))

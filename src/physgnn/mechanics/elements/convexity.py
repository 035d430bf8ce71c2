"""The nearest elasticity that resists every change of F: A without negative parts.

Far from equilibrium the pressure in nearly incompressible cells exceeds their shear
modulus, and the tangent is not positive definite, though the solid is stable where the
iteration goes. Without the negative eigenvalues of A = ∂P/∂F, cell by cell, it is. Such
a tangent is at least as stiff as the true one, so that iterations with it come to rest
wherever the solid does.

Source: Teran, Sifakis, Irving & Fedkiw, "Robust quasistatic finite elements and flesh
simulation", ACM SIGGRAPH/Eurographics Symposium on Computer Animation 2005, 181–190.
"""

import numpy as np
from numba import njit


@njit(cache=True)
def make_convex(A):  # type: ignore[no-untyped-def]
    """Take the negative eigenvalues out of A (3, 3, 3, 3), in place."""
    values, vectors = np.linalg.eigh(A.reshape(9, 9))
    M = A.reshape(9, 9)
    for k in range(9):
        if values[k] < 0.0:
            for i in range(9):
                for j in range(9):
                    M[i, j] -= values[k] * vectors[i, k] * vectors[j, k]

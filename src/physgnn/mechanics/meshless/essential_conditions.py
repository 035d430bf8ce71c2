"""Points held in place, though the approximation does not interpolate.

Nodal parameters are not displacements: u(X_c) = Σ φ_j(X_c) u_j. Forces r_c on the held
points, spread by the same shape functions, correct each time step so that the
approximation itself is where it must be, Φ u = ū:

    u ← u − M⁻¹ Φᵀ (Φ M⁻¹ Φᵀ)⁻¹ (Φ u − ū).

The matrix in the middle has a row a held point and is factorised once. These forces are
the reactions.

Source: the method EBCIEM of Joldes, Chowdhury, Wittek, Doyle & Miller 2017, "A new
method for essential boundary conditions imposition in explicit meshless methods",
Engineering Analysis with Boundary Elements 80, 94–104.
"""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError


class EssentialConditions:
    """Displacements given at points, imposed on nodal parameters.

    Parameters
    ----------
    shape : (n_points, n_points) sparse matrix
        φ_j at every point, a row each.
    held : (n_held,) integer array
        Points whose displacement is given.
    mass : (n_points,) array
        Of the explicit scheme.

    Raises
    ------
    InputError
        If the displacement of held points cannot be given independently.
    """

    def __init__(self, shape: sp.csr_matrix, held: IntArray, mass: FloatArray) -> None:
        self._shape = shape[held]
        self._spread = self._shape.T.tocsr()
        self._mass = mass[:, None]
        middle = self._shape @ sp.diags(1.0 / mass) @ self._spread
        try:
            self._factor = splu(
                middle.tocsc(),
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:
            raise InputError(
                "held points lie too close together to be held one by one: merge "
                "points that coincide"
            ) from error

    def impose(self, u: FloatArray, place: FloatArray) -> FloatArray:
        """Return the nearest parameters with Φ u = `place`, (n_held, 3), mm."""
        force = self._factor.solve(self._shape @ u - place)
        imposed: FloatArray = u - (self._spread @ force) / self._mass
        return imposed

    def reaction(self, force: FloatArray) -> FloatArray:
        """Return Φᵀ r_c, what held points answer a force on all parameters with, N."""
        answer: FloatArray = self._spread @ self._factor.solve(
            np.asarray(self._shape @ (force / self._mass))
        )
        return answer

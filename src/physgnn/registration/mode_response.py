"""What load modes do about a state: dead forces, and tissue that has grown so far.

A growth mode is no dead force. As such it would not be stable: forces that swell nearly
incompressible tissue by a few per cent are as large as its shear modulus. Instead the
stress-free state of the cells follows the coefficients,

    f_int(u; θ(w)) = B w,    θ = 1 + Σ w_k c_k,

c_k the pattern of mode k. About (u, w₀) its column is −∂f_int/∂w_k, and the step that
is left without any load is counted from w = 0, so that a whole step is again the sum of
all responses times their coefficients.
"""

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.elements.growth import grown, growth_force
from physgnn.mechanics.loads.growth import LEAST_RATIO, MOST_RATIO
from physgnn.registration.load_families import LoadModes
from physgnn.registration.tangent_response import Fields, TangentResponse


class ModeResponse:
    """Responses of a body to its load modes, about any state.

    Parameters
    ----------
    tangent : TangentResponse
        Linear elasticity about any state.
    modes : LoadModes
        Dead forces first, growth last.
    """

    def __init__(self, tangent: TangentResponse, modes: LoadModes) -> None:
        self._tangent, self._modes = tangent, modes

    def __call__(
        self, displacement: FloatArray, w: FloatArray
    ) -> tuple[Fields, FloatArray] | None:
        """Return every mode's response and the step backward, mm.

        Parameters
        ----------
        displacement : (n_points, 3) array
            u, mm.
        w : (r,) array
            The coefficients that go with it; only those of growth matter.

        Returns
        -------
        (r, n_points, 3) float32 array, (n_points, 3) array, or None
            None if a cell is inverted or the body not stable there.
        """
        growth = self._modes.growth
        if not len(growth):
            return self._tangent(displacement, self._modes.forces)
        grown_by = w[len(w) - len(growth) :]
        at_rest = self._tangent.elements
        ratio = np.clip(1.0 + grown_by @ growth, LEAST_RATIO, MOST_RATIO)
        forces = self._modes.forces.copy()
        for k, change in enumerate(growth, start=len(w) - len(growth)):
            forces[k] = -growth_force(at_rest, ratio, change, displacement)
        found = self._tangent(displacement, forces, grown(at_rest, ratio))
        if found is None:
            return None
        response, backward = found
        spent = np.tensordot(grown_by, response[len(w) - len(growth) :], 1)
        return response, backward - spent

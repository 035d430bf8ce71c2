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
from physgnn.mechanics.elements.tet4 import internal_force
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
        growth, n_dead = self._modes.growth, self._n_dead
        if not len(growth):
            return self._tangent(displacement, self._modes.forces)
        at_rest, ratio = self._tangent.elements, self._ratio(w)
        forces = self._modes.forces.copy()
        for k, change in enumerate(growth, start=n_dead):
            forces[k] = -growth_force(at_rest, ratio, change, displacement)
        found = self._tangent(displacement, forces, grown(at_rest, ratio))
        if found is None:
            return None
        response, backward = found
        return response, backward - np.tensordot(w[n_dead:], response[n_dead:], 1)

    def backward(
        self, displacement: FloatArray, w: FloatArray, response: Fields
    ) -> FloatArray | None:
        """Return the step backward by the tangent that was factorised last, mm.

        Parameters
        ----------
        displacement : (n_points, 3) array
            u, mm.
        w : (r,) array
            The coefficients that go with it.
        response : (r, n_points, 3) array
            Of every mode by that tangent.

        Returns
        -------
        (n_points, 3) array or None
            None if a cell is inverted.
        """
        if not len(self._modes.growth):
            return self._tangent.backward(displacement)
        elements = grown(self._tangent.elements, self._ratio(w))
        found = self._tangent.backward(displacement, elements)
        if found is None:
            return None
        n_dead = self._n_dead
        moved: FloatArray = found - np.tensordot(w[n_dead:], response[n_dead:], 1)
        return moved

    def unbalanced(self, displacement: FloatArray, w: FloatArray) -> FloatArray | None:
        """Return B w − f_int(u; θ(w)), N: what still pushes the body at a state.

        Parameters
        ----------
        displacement : (n_points, 3) array
            u, mm.
        w : (r,) array
            The coefficients.

        Returns
        -------
        (n_points, 3) array or None
            None if a cell is inverted.
        """
        elements = self._tangent.elements
        if len(self._modes.growth):
            elements = grown(elements, self._ratio(w))
        inner = self._tangent.inner_force(displacement, elements)
        return None if inner is None else self._dead(w) - inner

    def forces(self, displacement: FloatArray, w: FloatArray) -> FloatArray:
        """Return the dead forces under which the body lies so without growth, N.

        Those of the dead modes, and what growth adds at the state: (n_points, 3).
        """
        total = self._dead(w)
        if len(self._modes.growth):
            at_rest = self._tangent.elements
            before, _ = internal_force(at_rest, displacement)
            after, _ = internal_force(grown(at_rest, self._ratio(w)), displacement)
            total += before - after
        return total

    def _dead(self, w: FloatArray) -> FloatArray:
        """Return B w, the dead forces, (n_points, 3), N."""
        forces = self._modes.forces[: self._n_dead]
        return np.tensordot(w[: self._n_dead], forces, 1).astype(np.float64)

    @property
    def _n_dead(self) -> int:
        return len(self._modes.forces) - len(self._modes.growth)

    def _ratio(self, w: FloatArray) -> FloatArray:
        """Return the volume ratio of every cell, within what tissue can have."""
        ratio = 1.0 + w[self._n_dead :] @ self._modes.growth
        found: FloatArray = np.clip(ratio, LEAST_RATIO, MOST_RATIO)
        return found

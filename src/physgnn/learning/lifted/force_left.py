"""By how much an expansion is out of balance near the loads, for the network to see.

The force that is left, f − f_int(u), is zero where the expansion is right. It tells the
network where it is wrong, and which way the cells there would go.
"""

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.inverted import extrapolated_force
from physgnn.mechanics.elements.subset import some_cells
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT


class ForceLeft:
    """Finds the force left at the points near loads, from the cells there alone.

    Parameters
    ----------
    body : Body
        With averaged elements nothing is found: lone cells do not have their pressure.
    near : (n_points,) boolean array
        The points.
    """

    def __init__(self, body: Body, near: BoolArray) -> None:
        self._elements = None
        if body.element == DEFAULT_ELEMENT:
            cells = np.any(near[body.elements.cells], axis=1)
            self._elements = some_cells(body.elements, cells)
        free = np.ones(len(near), dtype=np.bool_)
        free[body.fixed] = False
        self._points = np.flatnonzero(near & free)

    def __call__(self, force: FloatArray, displacement: FloatArray) -> FloatArray:
        """Return what is left of a load, (n_points, 3) N; zero beyond and where fixed.

        Parameters
        ----------
        force : (n_points, 3) array
            The load, N.
        displacement : (n_points, 3) array
            mm; it may invert cells (`physgnn.mechanics.elements.inverted`).
        """
        left = np.zeros_like(force)
        if self._elements is not None:
            inner, _ = extrapolated_force(self._elements, displacement)
            left[self._points] = (force - inner)[self._points]
        return left

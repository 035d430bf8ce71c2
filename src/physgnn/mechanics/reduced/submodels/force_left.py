"""By how much a displacement is out of balance near the loads.

The force that is left, f − f_int(u), is zero where the displacement is right. It tells
where it is wrong, and which way the cells there would go.
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

    Attributes
    ----------
    points : integer array
        Those of them that are free.
    """

    def __init__(self, body: Body, near: BoolArray) -> None:
        self._elements = None
        if body.element == DEFAULT_ELEMENT:
            cells = np.any(near[body.elements.cells], axis=1)
            self._elements = some_cells(body.elements, cells)
        free = np.ones(len(near), dtype=np.bool_)
        free[body.fixed] = False
        self.points = np.flatnonzero(near & free)

    def at_points(self, force: FloatArray, displacement: FloatArray) -> FloatArray:
        """Return what is left of a load at `points`, (n, 3) N; see `__call__`."""
        if self._elements is None:
            return np.zeros((len(self.points), 3))
        inner, _ = extrapolated_force(self._elements, displacement)
        left: FloatArray = (force - inner)[self.points]
        return left

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
        left[self.points] = self.at_points(force, displacement)
        return left

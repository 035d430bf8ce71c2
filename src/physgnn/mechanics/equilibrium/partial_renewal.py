"""The stiffness renewed where a body has deformed most, and left in the rest.

A load deforms the cells near it far more than others. The tenth of the points that
have deformed most has most of the change of K, and costs a hundredth of the whole to
factorise.
"""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.elements.tangent import Pattern, assemble_tangent
from physgnn.mechanics.elements.tet4 import Elements
from physgnn.mechanics.linear.condensation import Condensation
from physgnn.mechanics.linear.protocols import Factor

PART = 0.1  # of the free points; 0.05 and 0.2 took as long or longer on 10,000
# Smaller bodies are factorised whole in the time of a few back-solves.
LEAST_UNKNOWNS = 10_000
PATIENCE = 8  # steps with one factor: a new one costs about 20
PATIENCE_WITH_PART = 3  # a part's costs about 4


class PartialRenewal:
    """A factor of K, renewed in a part.

    Parameters
    ----------
    elements : Elements
    pattern : Pattern
        Of the tangent.
    whole : Factor
        Holds the factor of the tangent at an earlier state.
    change : (n_points, 3) array
        Displacement since that state, mm: where it strains most is the part.
    threads : int
        Of the linear solver.
    """

    def __init__(
        self,
        elements: Elements,
        pattern: Pattern,
        whole: Factor,
        change: FloatArray,
        *,
        threads: int,
    ) -> None:
        points = most_deformed(elements, pattern.free, change)
        self._pattern = pattern
        self._linear = Condensation(pattern, points, whole, threads=threads)
        chosen = np.zeros(elements.n_points, dtype=np.bool_)
        chosen[points] = True
        self._cells = np.flatnonzero(chosen[elements.cells].any(axis=1))

    def renew(
        self, elements: Elements, displacement: FloatArray, stiffness: FloatArray
    ) -> bool:
        """Bring the part up to date; False if K is not positive definite there.

        Parameters
        ----------
        elements : Elements
            Of the whole body.
        displacement : (n_points, 3) array
            mm.
        stiffness : (n_points,) array
            Of springs at the points, N/mm.
        """
        data, inverted = assemble_tangent(
            elements, self._pattern, displacement, cells=self._cells
        )
        self._pattern.add_to_diagonal(data, stiffness)
        return inverted < 0 and self._linear.factorize(data)

    def solve(self, right: FloatArray) -> FloatArray:
        """Return K⁻¹ b, nearly, (n_unknowns,)."""
        return self._linear.solve(right)


def most_deformed(elements: Elements, free: IntArray, change: FloatArray) -> IntArray:
    """Return the free points whose cells have the largest displacement gradients.

    They are the part ``PART`` of the free points, at least one, in order.
    """
    corners = change[elements.cells]
    gradient = np.einsum("eai,eaj->eij", corners, elements.gradients)
    size = np.linalg.norm(gradient, axis=(1, 2))
    largest = np.zeros(elements.n_points)
    np.maximum.at(largest, elements.cells.ravel(), np.repeat(size, 4))
    n_chosen = max(1, int(PART * len(free)))
    order = np.argsort(-largest[free], kind="stable")
    return np.sort(free[order[:n_chosen]])


def worn_out(size: float, previous: float, since_factor: int, *, partial: bool) -> bool:
    """Whether a new factor, of a part or of all, is cheaper than going on.

    Parameters
    ----------
    size, previous : float
        Largest displacements of this step and the one before, mm.
    since_factor : int
        Steps with the present factor.
    partial : bool
        Whether a part's would do.
    """
    patience, least = (PATIENCE_WITH_PART, 2) if partial else (PATIENCE, 3)
    return since_factor >= patience or (since_factor >= least and size > previous)

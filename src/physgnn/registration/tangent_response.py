"""How a deformed body responds to a little more force: K(u)⁻¹ f."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent
from physgnn.mechanics.elements.tet4 import Elements, internal_force
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.linear.mkl import all_threads
from physgnn.mechanics.support import check_held
from physgnn.registration.skull import Support

Fields = NDArray[np.float32]


class TangentResponse:
    """Linear elasticity about any state, in equilibrium or not.

    Its `elements` are the body's, before any growth.

    Parameters
    ----------
    body : Body
        What is loaded.
    support : Support
        How the skull holds its fixed points.
    """

    def __init__(self, body: Body, support: Support) -> None:
        check_held(body.mesh, body.fixed)  # for good, or by the skull's springs
        self.elements = body.elements
        self._pattern = body.pattern_holding(support.held)
        self._support = support
        # Responses are kept in single precision: so may be their factor.
        self._linear = make_linear_solver(
            self._pattern, precision="single", threads=all_threads()
        )

    def __call__(
        self,
        displacement: FloatArray,
        forces: Fields,
        elements: Elements | None = None,
    ) -> tuple[Fields, FloatArray] | None:
        """Return the responses K(u)⁻¹ f and the step backward −K(u)⁻¹ f_int(u), mm.

        Under forces f a Newton step from u is the sum of the two.

        Parameters
        ----------
        displacement : (n_points, 3) array
            u, mm.
        forces : (k, n_points, 3) array
            N.
        elements : Elements, optional
            As they have grown; by default those of the rest state.

        Returns
        -------
        (k, n_points, 3) float32 array, (n_points, 3) array, or None
            None if a cell is inverted, or nothing holds the body.
        """
        inner = self.linearise(displacement, elements)
        if inner is None:
            return None
        # in single precision, as the factor: hundreds of fields take their time
        loads = np.concatenate([forces, -inner[None].astype(np.float32)])
        moved = self._linear.solve(self._pattern.unknowns(loads))
        response = self._pattern.on_points(moved[:-1].astype(np.float32))
        return response, self._pattern.on_points(moved[-1])

    def linearise(
        self, displacement: FloatArray, elements: Elements | None = None
    ) -> FloatArray | None:
        """Factorise the tangent about a state, which `solve` and `backward` use.

        Where it is not positive definite, as far from equilibrium it may not be, the
        nearest convex one is taken.

        Parameters
        ----------
        displacement : (n_points, 3) array
            u, mm.
        elements : Elements, optional
            As they have grown; by default those of the rest state.

        Returns
        -------
        (n_points, 3) array or None
            f_int(u), N; None if a cell is inverted, or nothing holds the body.
        """
        elements = self.elements if elements is None else elements
        inner = self.inner_force(displacement, elements)
        if inner is None:
            return None
        for convex in (False, True):
            data, _ = assemble_tangent(
                elements, self._pattern, displacement, convex=convex
            )
            self._support.add_tangent(self._pattern, data)
            if self._linear.factorize(data):
                return inner
        return None

    def solve(self, forces: NDArray[Any]) -> Fields:
        """Return K⁻¹ f by the tangent that was factorised last, mm.

        Parameters
        ----------
        forces : (k, n_points, 3) array
            N; taken in single precision, as the factor is.
        """
        right: NDArray[Any] = self._pattern.unknowns(forces.astype(np.float32))
        moved = self._linear.solve(right)
        return self._pattern.on_points(moved.astype(np.float32))

    def backward(
        self, displacement: FloatArray, elements: Elements | None = None
    ) -> FloatArray | None:
        """Return the step backward by the tangent that was factorised last, mm.

        Parameters
        ----------
        displacement : (n_points, 3) array
            u, mm.
        elements : Elements, optional
            As they have grown; by default those of the rest state.

        Returns
        -------
        (n_points, 3) array or None
            −K⁻¹ f_int(u), K of another state; None if a cell is inverted.
        """
        inner = self.inner_force(
            displacement, self.elements if elements is None else elements
        )
        if inner is None:
            return None
        right = self._pattern.unknowns(-inner[None])
        moved: FloatArray = self._pattern.on_points(self._linear.solve(right))[0]
        return moved

    def inner_force(
        self, displacement: FloatArray, elements: Elements
    ) -> FloatArray | None:
        """Return f_int(u) with the skull's, N; None if a cell is inverted.

        Parameters
        ----------
        displacement : (n_points, 3) array
            u, mm.
        elements : Elements
            As they have grown.
        """
        inner, inverted = internal_force(elements, displacement)
        if inverted >= 0:
            return None
        self._support.add_force(displacement, inner)
        return inner

"""The linear solution: one factorisation of the rest-state tangent for all loads."""

from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.linear.factor_cache import factorize_cached

LARGE = 30_000  # points; smaller bodies are factorised in less than two seconds


class RestState:
    """u = K₀⁻¹ f, the linear (rest-state) solution.

    Parameters
    ----------
    body : Body
        What is loaded. The factor of a large one (30 000 points) is cached in its
        folder of factors, if it has one.
    threads : int
        Threads for factorisation and back-solves.
    cache : Path, optional
        Folder that caches the factor from run to run, however small the body.

    Raises
    ------
    InputError
        If the fixed points don't hold the body.
    """

    def __init__(
        self, body: Body, *, threads: int = 1, cache: Path | None = None
    ) -> None:
        self.n_points = body.mesh.n_points
        self._pattern = pattern = body.pattern
        rest = np.zeros_like(body.mesh.points)
        data, _ = assemble_tangent(body.elements, pattern, rest)
        if cache is None and self.n_points >= LARGE:
            cache = body.factors
        self._solver = make_linear_solver(
            pattern, threads=threads, storable=cache is not None
        )
        positive = (
            factorize_cached(self._solver, pattern, data, cache)
            if cache
            else self._solver.factorize(data)
        )
        if not positive:
            raise InputError(
                "the fixed points don't hold the body: its stiffness matrix is "
                "singular; fix at least three points that are not in line"
            )

    def solve(self, forces: FloatArray) -> FloatArray:
        """Return K₀⁻¹ f.

        Parameters
        ----------
        forces : (n_points, 3) or (n_cases, n_points, 3) array
            N. Forces on fixed points go into the support.

        Returns
        -------
        array of the same shape
            Displacement, mm; zero at fixed points.
        """
        forces = np.asarray(forces, dtype=np.float64)
        cases = forces.reshape(-1, self.n_points, 3)
        solved = self._solver.solve(self._pattern.unknowns(cases))
        return self._pattern.on_points(solved).reshape(forces.shape)

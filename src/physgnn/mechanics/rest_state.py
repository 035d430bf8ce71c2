"""The linear answer: one factorisation of the rest-state tangent for all loads."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.assembly import assemble_tangent, make_pattern
from physgnn.mechanics.element import make_elements
from physgnn.mechanics.factor_cache import factorize_cached
from physgnn.mechanics.linear_solver import make_linear_solver
from physgnn.mechanics.materials.table import Material

FloatArray = NDArray[np.float64]


class RestState:
    """u = K₀⁻¹ f, the linear (rest-state) solution.

    Parameters
    ----------
    mesh : TetMesh
    materials : mapping of region label to Material
    fixed : str or integer array
        Name of a point set, or point indices.
    threads : int
        Threads for factorisation and back-solves.
    element : str
        As in `SolverOptions`.
    cache : Path, optional
        Folder that keeps the factor from run to run; worth it for large meshes.

    Raises
    ------
    InputError
        If the fixed points don't hold the body.
    """

    def __init__(
        self,
        mesh: TetMesh,
        materials: Mapping[int, Material],
        fixed: str | NDArray[np.int64] = "fixed",
        *,
        threads: int = 1,
        element: str = "tet4",
        cache: Path | None = None,
    ) -> None:
        self.n_points = mesh.n_points
        self.fixed = fixed_points(mesh, fixed)
        elements = make_elements(mesh, materials, element)
        pattern = make_pattern(
            mesh.cells, mesh.n_points, self.fixed, elements.averaging
        )
        self._free = pattern.free
        data, _ = assemble_tangent(elements, pattern, np.zeros_like(mesh.points))
        self._solver = make_linear_solver(pattern, threads=threads)
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
        answer = np.zeros_like(cases)
        right = cases[:, self._free].reshape(len(cases), -1)
        answer[:, self._free] = self._solver.solve(right).reshape(len(cases), -1, 3)
        return answer.reshape(forces.shape)


def fixed_points(mesh: TetMesh, fixed: str | NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the fixed points' indices, sorted; InputError if they cannot serve."""
    points = mesh.point_set(fixed) if isinstance(fixed, str) else np.asarray(fixed)
    points = np.unique(points).astype(np.int64)
    if len(points) < 3:
        raise InputError(
            f"at least three points must be fixed (got {len(points)}): "
            "otherwise the body floats away"
        )
    if points[0] < 0 or points[-1] >= mesh.n_points:
        raise InputError(
            f"fixed points must index 0…{mesh.n_points - 1} "
            f"(got {points[0]}…{points[-1]})"
        )
    return points

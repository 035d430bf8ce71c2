"""The few shapes that a body answers with to forces on some of its points.

G = Eᵀ K⁻¹ E, the flexibility of the points that forces act on, has eigenvectors v with
eigenvalues λ. The static responses

    φ = K⁻¹ E v / √λ

are orthonormal in energy, φᵀ K φ' = δ. So Galerkin's solution for a force f is
Φ Φᵀ f, and of all m shapes those of the m largest λ come nearest to K⁻¹ E in energy.
In component mode synthesis they are called attachment modes, ordered by softness.
"""

from collections.abc import Callable

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from physgnn.arrays import FloatArray, IntArray

TOLERANCE = (
    1e-6  # of the eigenvalues; single precision, in which K⁻¹ comes, has no more
)
SMALLEST = 1e-6  # of the largest eigenvalue: below it is rounding, of either sign
DENSE = 3  # G is made whole if it has at most so many rows a mode: that is as fast


def softest_responses(
    solve: Callable[[FloatArray], FloatArray],
    nodes: IntArray,
    n_points: int,
    n_modes: int,
) -> FloatArray:
    """Return the softest responses of a body to forces on some points.

    Parameters
    ----------
    solve : callable
        From force fields (…, n_points, 3) in N to K⁻¹ f in mm.
    nodes : (n_nodes,) integer array
        Points that forces act on, none of them fixed.
    n_points : int
        Points of the body.
    n_modes : int
        How many are wanted.

    Returns
    -------
    (n_modes, n_points, 3) array
        Softest first, mm / √(N mm); zero where there are fewer, or where rounding
        leaves no more.
    """
    modes = np.zeros((n_modes, n_points, 3))
    wanted = min(n_modes, 3 * len(nodes))
    if wanted == 0:
        return modes

    def on_points(forces: FloatArray) -> FloatArray:
        field = np.zeros((len(forces), n_points, 3))
        field[:, nodes] = forces.reshape(len(forces), -1, 3)
        return field

    softness, forces = _softest(solve, on_points, nodes, wanted)
    if len(softness):
        modes[: len(softness)] = solve(on_points(forces / np.sqrt(softness)[:, None]))
    return modes


def _softest(
    solve: Callable[[FloatArray], FloatArray],
    on_points: Callable[[FloatArray], FloatArray],
    nodes: IntArray,
    n_modes: int,
) -> tuple[FloatArray, FloatArray]:
    """Return the largest eigenvalues of G, mm/N, and their vectors as rows."""
    n = 3 * len(nodes)

    def flexibility(forces: FloatArray) -> FloatArray:
        return solve(on_points(forces))[:, nodes].reshape(len(forces), n)

    if n <= DENSE * n_modes:
        whole = flexibility(np.eye(n))
        values, vectors = np.linalg.eigh((whole + whole.T) / 2)
    else:
        start = np.random.default_rng(0).standard_normal(n)  # the same every time
        matrix = LinearOperator((n, n), lambda v: flexibility(v.reshape(1, n))[0])
        try:
            values, vectors = eigsh(matrix, k=n_modes, v0=start, tol=TOLERANCE)
        except ArpackNoConvergence as some:  # as many as rounding lets converge
            values, vectors = some.eigenvalues, some.eigenvectors
    softest = np.argsort(values)[::-1][:n_modes]
    softest = softest[values[softest] > SMALLEST * values.max(initial=0.0)]
    return values[softest], vectors[:, softest].T

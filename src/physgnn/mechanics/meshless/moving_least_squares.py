"""Modified moving least squares: shape functions of scattered points.

At a place x the quadratic polynomial that fits the points around it best, each by the
weight of its distance, gives the approximation u(x) = Σ φ_j(x) u_j. Where the
neighbours cannot tell the quadratic terms, as in a plane, ordinary moving least squares
has no solution; a small penalty on these terms alone gives one:

    φ_j(x) = p(x)ᵀ M⁻¹ w_j p(x_j),
    M = Σ_j w_j p(x_j) p(x_j)ᵀ + diag(0, …, 0, ε, …, ε).

Constants and linear fields cost no penalty and are reproduced exactly, quadratic ones
to about ε.

Source: Joldes, Chowdhury, Wittek, Doyle & Miller 2015, "Modified moving least squares
with polynomial bases for scattered data approximation", Applied Mathematics and
Computation 266, 893–902; the quartic spline: Belytschko et al. 1996, Comput. Methods
Appl. Mech. Engrg. 139, 3–47.
"""

import numpy as np
from numba import njit

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.mechanics.meshless.supports import Neighbours

N_TERMS = 10  # 1, x, y, z and the six products
PENALTY = 1e-7  # ε on coordinates over the support radius; the source's


def shape_functions(
    points: FloatArray, radii: FloatArray, places: FloatArray, near: Neighbours
) -> tuple[FloatArray, FloatArray]:
    """Evaluate shape functions and their gradients.

    Parameters
    ----------
    points : (n_points, 3) array
        mm.
    radii : (n_places,) array
        Support radii, mm; constants to the derivative.
    places : (n_places, 3) array
        Where to evaluate, mm.
    near : Neighbours
        Of the places.

    Returns
    -------
    values : (n_pairs,) array
        φ_j(x) in the order of `near.nodes`.
    gradients : (n_pairs, 3) array
        ∂φ_j/∂X, 1/mm.

    Raises
    ------
    InputError
        If the neighbours of a place lie in one plane.
    """
    values = np.empty(len(near.nodes))
    gradients = np.empty((len(near.nodes), 3))
    try:
        _evaluate(places, near.start, near.nodes, points, radii, values, gradients)
    except np.linalg.LinAlgError as error:
        raise InputError(
            "the points around a place lie in one plane: a meshless approximation "
            "needs two layers of points or more; refine the mesh where it is thin"
        ) from error
    return values, gradients


@njit(cache=True)
def _evaluate(  # type: ignore[no-untyped-def]
    places, start, nodes, points, radii, values, gradients
):
    p, w, dw = np.empty(N_TERMS), 0.0, np.empty(3)
    M, dM = np.empty((N_TERMS, N_TERMS)), np.empty((3, N_TERMS, N_TERMS))
    first, right = np.zeros((N_TERMS, 1)), np.empty((N_TERMS, 3))
    first[0, 0] = 1.0  # p(x), as coordinates are relative to x
    for q in range(len(places)):
        M[:], dM[:] = 0.0, 0.0
        for i in range(4, N_TERMS):
            M[i, i] = PENALTY
        for n in range(start[q], start[q + 1]):
            w = _weigh(points[nodes[n]], places[q], radii[q], p, dw)
            for i in range(N_TERMS):
                for j in range(N_TERMS):
                    product = p[i] * p[j]
                    M[i, j] += w * product
                    for k in range(3):
                        dM[k, i, j] += dw[k] * product
        a = np.linalg.solve(M, first)
        for k in range(3):  # ∂M⁻¹ = −M⁻¹ ∂M M⁻¹
            for i in range(N_TERMS):
                right[i, k] = 1.0 / radii[q] if i == k + 1 else 0.0
                for j in range(N_TERMS):
                    right[i, k] -= dM[k, i, j] * a[j, 0]
        b = np.linalg.solve(M, right)
        for n in range(start[q], start[q + 1]):
            w = _weigh(points[nodes[n]], places[q], radii[q], p, dw)
            fit = 0.0
            for i in range(N_TERMS):
                fit += a[i, 0] * p[i]
            values[n] = w * fit
            for k in range(3):
                slope = 0.0
                for i in range(N_TERMS):
                    slope += b[i, k] * p[i]
                gradients[n, k] = dw[k] * fit + w * slope


@njit(cache=True, inline="always")
def _weigh(point, place, radius, p, dw):  # type: ignore[no-untyped-def]
    """Fill p and ∂w/∂x, return w = 1 − 6 s² + 8 s³ − 3 s⁴, s = distance/radius."""
    x, y, z = point[0] - place[0], point[1] - place[1], point[2] - place[2]
    s = min(np.sqrt(x * x + y * y + z * z) / radius, 1.0)
    rate = 12.0 * (1.0 - s) ** 2 / radius**2
    dw[0], dw[1], dw[2] = rate * x, rate * y, rate * z
    x, y, z = x / radius, y / radius, z / radius
    p[0], p[1], p[2], p[3] = 1.0, x, y, z
    p[4], p[5], p[6] = x * x, x * y, x * z
    p[7], p[8], p[9] = y * y, y * z, z * z
    return (1.0 - s) ** 3 * (1.0 + 3.0 * s)

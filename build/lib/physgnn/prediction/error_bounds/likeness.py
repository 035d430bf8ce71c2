"""Whether a body is like those whose errors were measured.

A family's bounds hold for new patients: for bodies drawn as its own were. Of a body of
another kind they say nothing, however well it may be predicted.
"""

import numpy as np

from physgnn.geometry.tetmesh import TetMesh, signed_volumes

# A newborn's brain has a fourth of an adult's volume; half is a small child's.
LARGEST_RATIO = 2.5
# Dice with the ellipsoid of the same moments: brains have 0.91 to 0.93, and 0.88 where
# a label map's folds are filled; halves of brains 0.85 to 0.87, a cube 0.84, a ball 1.
BELOW, ABOVE = 0.055, 0.03


def reasons_unlike(body: TetMesh, known: TetMesh) -> tuple[str, ...]:
    """Return why a body is unlike a known one, a line each; empty if it is like it.

    Parameters
    ----------
    body, known : TetMesh
        The new one, and one of those whose errors were measured.
    """
    ml, known_ml = (float(_volumes(mesh).sum()) / 1000.0 for mesh in (body, known))
    round_, known_round = roundness(body), roundness(known)
    checks = (
        (
            not 1.0 / LARGEST_RATIO <= ml / known_ml <= LARGEST_RATIO,
            f"it has {ml:.3g} ml (the network learnt from about {known_ml:.3g})",
        ),
        (
            not -BELOW <= round_ - known_round <= ABOVE,
            f"its overlap with an ellipsoid is {round_:.2f} (of those that the network "
            f"learnt from {known_round:.2f})",
        ),
    )
    return tuple(text for is_unlike, text in checks if is_unlike)


def roundness(mesh: TetMesh) -> float:
    """Return the Dice of a body with the solid ellipsoid that has its moments, 0 to 1.

    Of a solid ellipsoid, the covariance of its points is its squared half axes over 5.
    """
    volumes = _volumes(mesh)
    corners = mesh.points[mesh.cells]
    centres = corners.mean(axis=1)
    weights = volumes / volumes.sum()
    middle = weights @ centres
    # of a tetrahedron, as that of its corners over 5 (with n in the denominator)
    away = corners - middle
    from_middle = centres - middle
    outer = np.einsum("cki,ckj->cij", away, away) / 20.0
    outer += 0.8 * np.einsum("ci,cj->cij", from_middle, from_middle)
    covariance = np.einsum("c,cij->ij", weights, outer)
    inverse = np.linalg.inv(5.0 * covariance)
    ellipsoid = 4.0 / 3.0 * np.pi / np.sqrt(np.linalg.det(inverse))
    inside = np.einsum("ni,ij,nj->n", from_middle, inverse, from_middle) <= 1.0
    shared = float(volumes[inside].sum())
    return float(2.0 * shared / (volumes.sum() + ellipsoid))


def _volumes(mesh: TetMesh) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.asarray(signed_volumes(mesh.points, mesh.cells), np.float64)

"""The points round a point, their cells, and what Newton's method needs of these.

A patch is small: its stiffness is one dense matrix, in single precision.
"""

import numpy as np
from numba import njit

from physgnn.mechanics.elements.cell_kinematics import kinematics
from physgnn.mechanics.elements.cell_tangent import cell_stiffness
from physgnn.mechanics.materials import table


@njit(cache=True)
def grow(  # type: ignore[no-untyped-def]
    centre, k_hops, cells, first_cell, cells_of, free, place, points, touched, seen
):
    """Find the free points within some edges of a free one, and all cells they touch.

    Parameters
    ----------
    centre, k_hops : int
    cells : (n_cells, 4) array
    first_cell, cells_of : arrays
        The cells of point p are cells_of[first_cell[p]:first_cell[p + 1]].
    free : (n_points,) boolean array
    place : (n_points,) array
        −1 everywhere; gets the number of each of the patch's points in it.
    points, touched : arrays
        Get the points and the cells, both long enough for all.
    seen : (n_cells,) boolean array
        False everywhere, before and after.

    Returns
    -------
    n, n_touched : int
        How many there are.
    """
    points[0], place[centre] = centre, 0
    n, n_touched, inner = 1, 0, 0
    for hop in range(k_hops + 1):
        outer = n
        for i in range(inner, outer):
            for at in range(first_cell[points[i]], first_cell[points[i] + 1]):
                e = cells_of[at]
                if seen[e]:
                    continue
                seen[e] = True
                touched[n_touched] = e
                n_touched += 1
                for q in cells[e]:
                    if hop < k_hops and free[q] and place[q] < 0:
                        points[n], place[q] = q, n
                        n += 1
        inner = outer
    seen[touched[:n_touched]] = False
    return n, n_touched


@njit(cache=True)
def newton_system(  # type: ignore[no-untyped-def]
    touched, cells, gradients, rest, volumes, law, constants, u, place, K, force
):
    """Add up the stiffness K, its lower half, and the force of a patch's points.

    Parameters
    ----------
    touched : array
        The patch's cells, as `grow` finds them.
    u : (n_points, 3) array
        mm.
    place : (n_points,) array
        As `grow` leaves it.
    K, force : (3 n, 3 n) and (3 n,) arrays
        Zero before; N/mm and N. Of no use if a cell is inverted.

    Returns
    -------
    float
        The strain energy of the cells, N mm; infinite if one of them is inverted.
    """
    F, H, P = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    room = np.empty((3, 3, 3, 3)), np.empty((3, 3, 3)), np.empty((4, 3))
    blocks = np.empty((4, 4, 3, 3))
    total = 0.0
    for e in touched:
        J = kinematics(cells[e], gradients[e], rest[e], u, F, H)
        if not J > 0.0:
            return np.inf
        total += volumes[e] * table.energy(law[e], F, J, constants[e])
        table.stress(law[e], F, H, J, constants[e], P)
        cell_stiffness(
            law[e], F, H, J, constants[e], gradients[e], volumes[e], room, blocks
        )
        for a in range(4):
            i = place[cells[e, a]]
            if i < 0:
                continue
            for r in range(3):
                part = P[r, 0] * gradients[e, a, 0] + P[r, 1] * gradients[e, a, 1]
                part += P[r, 2] * gradients[e, a, 2]
                force[3 * i + r] += volumes[e] * part
            for b in range(4):
                j = place[cells[e, b]]
                if j > i:
                    continue
                for r in range(3):
                    for c in range(3):
                        value = blocks[a, b, r, c] if a <= b else blocks[b, a, c, r]
                        if j >= 0:
                            K[3 * i + r, 3 * j + c] += value
    return total

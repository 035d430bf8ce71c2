"""The internal force of states with inverted cells, which have no stress.

Where det F ≤ J₀ the stress is extrapolated along the straight line from the undeformed
cell: with F₀ = I + t (F − I) the last point of it at which det ≥ J₀,

    P(F) = P(F₀) + ∂P/∂F(F₀) : (F − F₀),

that is, the energy goes on as a parabola. It serves to judge guesses, not to solve.
"""

import numpy as np
from numba import njit

from physgnn.arrays import FloatArray
from physgnn.mechanics.elements.cell_kinematics import kinematics
from physgnn.mechanics.elements.tet4 import Elements, _add_force, check_state
from physgnn.mechanics.materials import table

SMALLEST_J = 0.05
BISECTIONS = 40


@njit(cache=True)
def _extrapolated_force(  # type: ignore[no-untyped-def]
    cells, gradients, rest, volumes, law, constants, u, force
):
    F, H, P = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    A, corner = np.empty((3, 3, 3, 3)), np.arange(4)
    n_inverted = 0
    for e in range(len(cells)):
        J = kinematics(cells[e], gradients[e], rest[e], u, F, H)
        if not J > 0.0:
            n_inverted += 1
        if J > SMALLEST_J:
            table.stress(law[e], F, H, J, constants[e], P)
        else:
            whole = F.copy()
            moved = u[cells[e]]
            sound, bad = 0.0, 1.0
            for _ in range(BISECTIONS):
                t = (sound + bad) / 2
                J = kinematics(corner, gradients[e], rest[e], t * moved, F, H)
                if J > SMALLEST_J:
                    sound = t
                else:
                    bad = t
            J = kinematics(corner, gradients[e], rest[e], sound * moved, F, H)
            table.stress(law[e], F, H, J, constants[e], P)
            table.tangent(law[e], F, H, J, constants[e], A)
            for i in range(3):
                for j in range(3):
                    for k in range(3):
                        for m in range(3):
                            P[i, j] += A[i, j, k, m] * (whole[k, m] - F[k, m])
        _add_force(cells[e], gradients[e], volumes[e], P, force)
    return n_inverted


def extrapolated_force(elements: Elements, u: FloatArray) -> tuple[FloatArray, int]:
    """Return the internal force of any state, without averaged changes of volume.

    Parameters
    ----------
    elements : Elements
    u : (n_points, 3) array
        mm.

    Returns
    -------
    force : (n_points, 3) array
        N; as `internal_force` where every det F > 0.05.
    n_inverted : int
        Cells with det F ≤ 0.
    """
    check_state(elements, u)
    force = np.zeros_like(u)
    n_inverted = _extrapolated_force(
        elements.cells,
        elements.gradients,
        elements.rest,
        elements.volumes,
        elements.law,
        elements.constants,
        u,
        force,
    )
    return force, int(n_inverted)

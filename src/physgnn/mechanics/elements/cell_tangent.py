"""The tangent of one linear tetrahedron, from its law and its deformation."""

from numba import njit

from physgnn.mechanics.materials import neo_hookean, table


@njit(cache=True)
def contracted(gradient, volume, A, Ag, K):  # type: ignore[no-untyped-def]
    """K_aibk = V ∂N_a/∂X_J A_iJkL ∂N_b/∂X_L, upper blocks b ≥ a only."""
    for b in range(4):
        for i in range(3):
            for j in range(3):
                for k in range(3):
                    Ag[i, j, k] = volume * (
                        A[i, j, k, 0] * gradient[b, 0]
                        + A[i, j, k, 1] * gradient[b, 1]
                        + A[i, j, k, 2] * gradient[b, 2]
                    )
        for a in range(b + 1):
            for i in range(3):
                for k in range(3):
                    K[a, b, i, k] = (
                        gradient[a, 0] * Ag[i, 0, k]
                        + gradient[a, 1] * Ag[i, 1, k]
                        + gradient[a, 2] * Ag[i, 2, k]
                    )


@njit(cache=True, inline="always")
def cell_stiffness(law, F, H, J, constants, gradient, volume, room, K):  # type: ignore[no-untyped-def]
    """Fill a cell's tangent, upper blocks only.

    `room` to work in are arrays (3, 3, 3, 3), (3, 3, 3) and (4, 3).
    """
    A, Ag, g = room
    if law == 0:  # its closed form takes less than half the time
        neo_hookean.stiffness(gradient, volume, H, J, constants, g, K)
    else:
        table.tangent(law, F, H, J, constants, A)
        contracted(gradient, volume, A, Ag, K)

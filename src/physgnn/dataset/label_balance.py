"""Whether a dataset's displacements are equilibria of its own finite elements.

Those of another solver need not be: a meshless method, other elements, a finer mesh.
What takes predictions to the elements' equilibrium then takes them away from the truth.
"""

import numpy as np

from physgnn.dataset.storage.store import Store
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.equilibrium.solution import Status

MOST_LEFT = 0.02  # of the load; equilibria stored in single precision leave 1e-4


def in_balance(store: Store) -> bool:
    """Return whether the first solved path's strongest load is balanced.

    Parameters
    ----------
    store : Store
        Of nodal forces. One without a solved path says nothing against it: True.
    """
    solved = np.argwhere(store.status == Status.CONVERGED)
    if len(solved) == 0:
        return True
    path = int(solved[0, 0])
    level = int(solved[solved[:, 0] == path, 1].max())
    body, case = store.body, store.load_case(path, level)
    u = store.displacement(path)[level].astype(np.float64)
    inner, inverted = internal_force(body.elements, u)
    load = case.on_points(store.mesh.n_points)
    free = np.ones(len(u), dtype=np.bool_)
    free[body.fixed] = False
    left = float(np.linalg.norm((load - inner)[free]))
    return inverted < 0 and left <= MOST_LEFT * float(np.linalg.norm(load[free]))

"""Whether a dataset's displacements are equilibria of its own finite elements.

Those of another solver need not be: a meshless method, other elements, a finer mesh.
What takes predictions to the elements' equilibrium then takes them away from the truth.
"""

import numpy as np

from physgnn.dataset.storage.store import Store
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.equilibrium.solution import Status

MOST_LEFT = 0.05  # of the load; equilibria stored in single precision leave 1e-5,
# near incompressibility 1e-2
MOST_PATHS = 3


def in_balance(store: Store) -> bool:
    """Return whether the strongest loads of the first, middle and last path balance.

    Parameters
    ----------
    store : Store
        Of nodal forces. One without a solved path says nothing against it: True.
    """
    solved = store.status == Status.CONVERGED
    paths = np.flatnonzero(solved.any(axis=1))
    some = np.linspace(0, len(paths) - 1, min(len(paths), MOST_PATHS), dtype=np.int64)
    return all(
        _balances(store, path, int(np.flatnonzero(solved[path])[-1]))
        for path in paths[some].tolist()
    )


def _balances(store: Store, path: int, level: int) -> bool:
    body, case = store.body, store.load_case(path, level)
    u = store.displacement(path)[level].astype(np.float64)
    inner, inverted = internal_force(body.elements, u)
    load = case.on_points(store.mesh.n_points)
    free = np.ones(len(u), dtype=np.bool_)
    free[body.fixed] = False
    left = float(np.linalg.norm((load - inner)[free]))
    return inverted < 0 and left <= MOST_LEFT * float(np.linalg.norm(load[free]))

"""What the networks of this room are given of every point, and in what units."""

import numpy as np
import torch
from torch import Tensor, nn

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store
from physgnn.learning.graph import as_float32
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase

TUMOUR_REGION = 1
N_KINDS = 3
N_INPUTS = N_KINDS + 3
"""Fixed, tumour or brain, one of them 1; the force on the point, in units of its own"""


class NodeInputs(nn.Module):
    """Kind and force of every point, without units, and the unit of displacement.

    Parameters
    ----------
    body : Body
        What is loaded.
    """

    force_unit: Tensor
    displacement_unit: Tensor
    free: Tensor

    def __init__(self, body: Body) -> None:
        super().__init__()
        self.register_buffer("force_unit", torch.ones(()))  # N
        self.register_buffer("displacement_unit", torch.ones(()))  # mm
        kinds = _kinds(body)
        self._kinds = as_float32(kinds)
        free = as_float32(1.0 - kinds[:, :1])
        self.register_buffer("free", free, persistent=False)  # 0 where held
        self._of_another = False

    def share_units(self, other: "NodeInputs") -> None:
        """Have the units of another body's inputs, also when they change."""
        self.force_unit, self.displacement_unit = (
            other.force_unit,
            other.displacement_unit,
        )
        self._of_another = True

    def fit(self, store: Store, samples: IntArray) -> None:
        """Take the root mean squares of loaded points' forces and of displacements.

        Not if the units are another's: weights know those alone.
        """
        if self._of_another:
            return
        forces, displacements = [], []
        for path in np.unique(samples[:, 0]):
            levels = samples[samples[:, 0] == path, 1]
            case = store.load_case(int(path), int(levels.max()))
            forces.append(_mean_square(case.forces))
            displacements.append(_mean_square(store.displacement(int(path))[levels]))
        for unit, squares in (
            (self.force_unit, forces),
            (self.displacement_unit, displacements),
        ):
            unit.fill_(float(np.sqrt(np.mean(squares))) or 1.0)

    def encode(self, load_case: LoadCase) -> Tensor:
        """Return a row a point, (n_points, 6) float32."""
        forces = load_case.on_points(len(self._kinds))
        return torch.cat(
            [self._kinds, as_float32(forces / float(self.force_unit))], dim=1
        )

    def displacement(self, found: Tensor) -> Tensor:
        """Return mm, zero at fixed points, of what a network says, (…, n_points, 3)."""
        return found * self.displacement_unit * self.free


def _kinds(body: Body) -> FloatArray:
    """Return (n_points, 3): fixed; tumour, if not fixed; brain, if neither."""
    n_points = body.mesh.n_points
    fixed, tumour = np.zeros(n_points, bool), np.zeros(n_points, bool)
    fixed[body.fixed] = True
    tumour[body.mesh.cells[body.mesh.region == TUMOUR_REGION].ravel()] = True
    kinds = [fixed, tumour & ~fixed, ~tumour & ~fixed]
    return np.column_stack(kinds).astype(np.float64)


def _mean_square(vectors: FloatArray) -> float:
    return float(np.square(vectors).sum(axis=-1).mean())

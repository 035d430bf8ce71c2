"""Operations in silico: the true brain moves, and a coarser one is registered.

The brain is shifted by forces, sags as the fluid drains, or loses its tumour, after
which the cavity falls together as the fluid drains.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.evaluation.in_silico.cases import Case, SeenPlaces
from physgnn.evaluation.in_silico.compared import Compared
from physgnn.evaluation.in_silico.physiological_shifts import (
    PhysiologicalShift,
    collapse,
    sag,
)
from physgnn.evaluation.in_silico.shifts import Truth
from physgnn.geometry import TetMesh
from physgnn.geometry.regions import TUMOUR
from physgnn.registration.causes import CAVITY
from physgnn.registration.removed_region import resected

NEAR_MM = 50.0
PHYSIOLOGICAL: Mapping[str, PhysiologicalShift] = {"sag": sag, "resection": collapse}
"""What may move a brain besides the forces of a shift."""
STREAMS = {"sag": 5, "resection": 6}  # of random numbers


@dataclass(frozen=True, eq=False)
class MovedBrain:
    """A brain that moved, and what was measured of it.

    Attributes
    ----------
    mesh : TetMesh
        The rest state of what is there after.
    case : Case
        Displacement and measurements.
    craniotomy_point : (3,) array
        The middle of the craniotomy, mm.
    """

    mesh: TetMesh
    case: Case
    craniotomy_point: FloatArray

    @property
    def areas(self) -> dict[str, BoolArray]:
        """The points of the whole brain, of what is near, of the tumour or its wall."""
        mesh, every = self.mesh, np.arange(self.mesh.n_points)
        tumour = np.unique(mesh.cells[mesh.region == TUMOUR])
        rim = mesh.point_sets.get(CAVITY, tumour)
        away = np.linalg.norm(mesh.points - self.craniotomy_point, axis=1)
        whole = np.ones(len(every), dtype=bool)
        return {"brain": whole, "near": away < NEAR_MM, "tumour": np.isin(every, rim)}


class Operations:
    """The true brain, and what is registered of it.

    Parameters
    ----------
    n_points : int
        About how many the registered mesh has; the true one has half as many more.
    skull : str
        A row of `physgnn.registration.skull.SUPPORTS`.
    """

    def __init__(self, n_points: int, skull: str) -> None:
        self.truth = Truth(int(1.5 * n_points), skull)
        self._n_points, self._skull = n_points, skull
        self._moved: dict[tuple[str, int], MovedBrain] = {}

    @cached_property
    def whole(self) -> Compared:
        """The brain with its tumour, with all causes in the prior."""
        x = self.truth.mesh.points
        return Compared(self._n_points, self._skull, x, None)

    @cached_property
    def resected(self) -> Compared:
        """The brain without its tumour, as that was segmented."""
        x = resected(self.truth.mesh, "tumour").remaining.points
        gone = self.truth.phantom.tumours
        given = self._n_points, self._skull, x, None
        return Compared(*given, removed="tumour", tumours=gone)

    def compared(self, condition: str) -> Compared:
        """Return what is registered under a condition."""
        return self.resected if condition == "resection" else self.whole

    def moved(self, condition: str, seed: int) -> MovedBrain:
        """Return how the brain truly moved: a row of `PHYSIOLOGICAL`, else a shift.

        Those of the last seed are kept.
        """
        name = condition if condition in PHYSIOLOGICAL else "shift"
        if (name, seed) not in self._moved:
            self._moved = {k: v for k, v in self._moved.items() if k[1] == seed}
            self._moved[name, seed] = self._simulated(name, seed)
        return self._moved[name, seed]

    def _simulated(self, name: str, seed: int) -> MovedBrain:
        middle = self.truth.phantom.craniotomy_point
        if name not in PHYSIOLOGICAL:
            return MovedBrain(self.truth.mesh, self.truth.case(seed), middle)
        rng = np.random.default_rng([seed, STREAMS[name]])
        mesh, u = PHYSIOLOGICAL[name](self.truth, rng)
        case = SeenPlaces(mesh, middle).measured(u, rng, seed)
        return MovedBrain(mesh, case, middle)

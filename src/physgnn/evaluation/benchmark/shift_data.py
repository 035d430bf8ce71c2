"""The data of a registration: simulated shifts, and what was measured of them."""

import hashlib
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from physgnn.arrays import BoolArray
from physgnn.dataset.splits.meshes import split_meshes
from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.evaluation.in_silico.cases import Case
from physgnn.evaluation.in_silico.compared import Compared, ShiftMeasured
from physgnn.evaluation.in_silico.shifts import Truth
from physgnn.evaluation.measure.metrics import points_near
from physgnn.mechanics.body import Body


def digest(*parts: bytes) -> str:
    """Return the SHA-256 of parts one after the other, in hexadecimal digits."""
    return hashlib.sha256(b"".join(parts)).hexdigest()


@dataclass(frozen=True)
class ShiftSize:
    """How large the shifts of a size are.

    Attributes
    ----------
    cases : int
        Shifts; their seeds are 0, 1, and so on.
    true_points, true_surface : int
        About how many points the mesh has that is shifted, and how many its surface.
    points, surface : int
        The same of the mesh that is registered.
    """

    cases: int
    true_points: int
    true_surface: int
    points: int
    surface: int


SHIFT_SIZES = {
    "tiny": ShiftSize(4, 1500, 450, 1000, 300),
    "full": ShiftSize(20, 3000, 900, 2000, 600),
}
"""Sizes of the registration tasks."""


@dataclass(frozen=True, eq=False)
class ShiftData:
    """The data of a registration task, at hand.

    Attributes
    ----------
    task, size : str
        A row of ``TASKS`` and a size.
    measured : str
        What is given of every shift, ``pairs`` or ``surface``.
    truth : Truth
        The body that shifts.
    cases : tuple of Case
        The shifts.
    body : Compared
        What is registered.
    family : tuple of Store
        Other bodies' datasets, for what learns.
    """

    task: str
    size: str
    measured: str
    truth: Truth
    cases: tuple[Case, ...]
    body: Compared
    family: tuple[Store, ...] = ()

    def given(self, case: Case) -> ShiftMeasured:
        """Return what was measured of a shift."""
        measured: ShiftMeasured = getattr(case, self.measured)
        return measured

    @cached_property
    def near(self) -> BoolArray:
        """The true points within 10 mm of the exposed surface."""
        return points_near(self.truth.mesh, self.truth.exposed)

    @property
    def registered(self) -> Body:
        """The body that is registered."""
        return self.body.body

    @property
    def trained_on(self) -> tuple[list[Store], list[Split]]:
        """The stores and splits of training; none where nothing learns."""
        splits = split_meshes(self.family) if self.family else []
        return list(self.family), splits

    @property
    def about(self) -> dict[str, Any]:
        """A hash of the data, and how many there are."""
        hashes = [store.content_hash().encode() for store in self.family]
        meshes = (self.truth.mesh, self.body.mesh)
        return {
            "hash": digest(
                *(mesh.content_hash.encode() for mesh in meshes),
                *(_bytes(case, self.measured) for case in self.cases),
                *hashes,
            ),
            "points": self.truth.mesh.n_points,
            "registered_points": self.body.mesh.n_points,
            "train": sum(len(split.train) for split in self.trained_on[1]),
            "test": len(self.cases),
        }

    @property
    def about_split(self) -> dict[str, Any]:
        """Every shift is held out: nothing learns from one."""
        return {"name": "shifts", "hash": digest(str(len(self.cases)).encode())}


def _bytes(case: Case, measured: str) -> bytes:
    arrays = [case.displacement]
    if measured == "pairs":
        arrays += [case.pairs.source, case.pairs.target]
    else:
        arrays += [case.surface.points]
    return b"".join(np.asarray(each, dtype="<f8").tobytes() for each in arrays)

"""A method on a task's data, and what its result follows from."""

import inspect
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from physgnn.dataset.splits.meshes import split_meshes
from physgnn.dataset.splits.samples import MESH, Split
from physgnn.dataset.storage.store import Store
from physgnn.evaluation.benchmark.methods import SHIFTS_ONLY, Method
from physgnn.evaluation.benchmark.result import Identity
from physgnn.evaluation.benchmark.shift_data import ShiftData, digest
from physgnn.evaluation.benchmark.tasks import TASKS
from physgnn.evaluation.measure.held_out import HeldOut
from physgnn.learning.models import MODELS, model_class
from physgnn.learning.network import Network
from physgnn.learning.surrogate import Surrogate


@dataclass(frozen=True, eq=False)
class TaskData:
    """The data of a task, at hand.

    Attributes
    ----------
    task, size : str
        A row of ``TASKS`` and a size.
    store : Store
        What is tested on, and where the split holds out samples, trained on.
    split : Split
        Which samples; of ``mesh`` the store's are all for testing.
    others : tuple of Store
        Of ``mesh``: the bodies that training has.
    """

    task: str
    size: str
    store: Store
    split: Split
    others: tuple[Store, ...] = ()

    @property
    def held_out(self) -> HeldOut:
        """The test samples."""
        return HeldOut.of(self.store, self.split)

    @property
    def trained_on(self) -> tuple[list[Store], list[Split]]:
        """The stores and splits of training."""
        if self.split.name != MESH:
            return [self.store], [self.split]
        return list(self.others), split_meshes(self.others)

    @property
    def about(self) -> dict[str, Any]:
        """A hash of the data, and how many there are."""
        stores: Sequence[Store] = (self.store, *self.others)
        return {
            "hash": digest(*(store.content_hash().encode() for store in stores)),
            "points": self.store.mesh.n_points,
            "train": sum(len(split.train) for split in self.trained_on[1]),
            "test": len(self.held_out.test),
        }

    @property
    def about_split(self) -> dict[str, Any]:
        """The split's name, and a hash of what is in which part."""
        return {"name": self.split.name, "hash": _split_hash(self.split)}


@dataclass(frozen=True, eq=False)
class MethodOnTask:
    """One method on one task.

    Attributes
    ----------
    method : Method
        With its options.
    data : TaskData or ShiftData
        What it learns from and is tested on.
    minutes : float
        Processor minutes that a network may train.
    seed : int
        Of whatever draws.
    runs : path
        The folder for trained networks.
    """

    method: Method
    data: TaskData | ShiftData
    minutes: float
    seed: int
    runs: Path

    @property
    def kind(self) -> type[Any]:
        """The method's class; of one that takes no load, that of all."""
        takes_loads = self.method.name not in SHIFTS_ONLY
        return model_class(self.method.model) if takes_loads else Surrogate

    @property
    def identity(self) -> Identity:
        """What its result follows from."""
        method, data, network = self.method, self.data, issubclass(self.kind, Network)
        options = {**method.options, "tolerance_mm": method.tolerance_mm}
        return Identity(
            task=data.task,
            version=TASKS[data.task].version,
            size=data.size,
            method=method.name,
            options={**options, **(method.training if network else {})},
            origin=_origin(self.kind, method.model),
            data=data.about,
            split=data.about_split,
            seed=self.seed if self.kind.draws else None,
            processor_minutes=self.minutes if network else None,
        )

    @property
    def run(self) -> Path:
        """The folder that its network is trained into, whatever is made of it then."""
        bare = replace(self.method, name=self.method.model, tolerance_mm=None)
        identity = replace(self, method=bare).identity
        return identity.file(self.runs).with_suffix("")


def _split_hash(split: Split) -> str:
    parts = (split.train, split.validation, split.test)
    return digest(*(part.astype("<i8").tobytes() + b"|" for part in parts))


def _origin(kind: type[Any], name: str) -> str:
    """Return a digest of the file that a method from outside the package is in."""
    if name in MODELS:
        return ""
    try:
        return digest(inspect.getsource(sys.modules[kind.__module__]).encode())
    except (OSError, TypeError):
        return "no source"  # compiled: a change of it is not seen

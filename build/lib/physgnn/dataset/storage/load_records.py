"""Loads beside nodal forces, as they are stored.

A load is a record, what JSON can hold, and arrays. Paths often share a load (a whole
dataset under the same gravity), so every load is stored once, and every path
names its own by number.
"""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.io.integrity.digest import digest_of
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.growth import VolumeGrowth
from physgnn.mechanics.loads.paths import Load, LoadPath
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.loads.pressure import SurfacePressure
from physgnn.mechanics.loads.springs import Springs

KINDS: Mapping[str, type[Load]] = {
    "pressure": SurfacePressure,
    "gravity": Gravity,
    "displacement": PrescribedDisplacement,
    "springs": Springs,
    "growth": VolumeGrowth,
}
Arrays = Mapping[str, NDArray[Any]]


def kind_of(load: Load) -> str:
    """Return the name of a load's kind."""
    return next(kind for kind, cls in KINDS.items() if isinstance(load, cls))


def to_record(load: Load) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return a load's kind and numbers, and its arrays."""
    values = {field.name: getattr(load, field.name) for field in fields(load)}
    arrays = {k: v for k, v in values.items() if isinstance(v, np.ndarray)}
    numbers = {k: v for k, v in values.items() if k not in arrays}
    return {"kind": kind_of(load), **numbers}, arrays


def from_record(record: Mapping[str, Any], arrays: Arrays) -> Load:
    """Return the load, the inverse of `to_record`."""
    values: dict[str, Any] = {**record, **arrays}
    return KINDS[values.pop("kind")](**values)


def digest(load: Load) -> str:
    """Return the SHA-256 of a load."""
    record, arrays = to_record(load)
    return digest_of(record, *(arrays[name] for name in sorted(arrays)))


def distinct(paths: Sequence[LoadPath]) -> tuple[dict[str, Load], NDArray[np.int32]]:
    """Return all loads by digest, each once, and which of them every path has.

    Returns
    -------
    loads : dict of str to load
    of_path : (n_paths, most) int32 array
        Places in `loads`; −1 where a path has fewer.
    """
    loads: dict[str, Load] = {}
    of_path = np.full((len(paths), max(len(p.more) for p in paths)), -1, np.int32)
    for i, path in enumerate(paths):
        for k, load in enumerate(path.more):
            name = digest(load)
            loads.setdefault(name, load)
            of_path[i, k] = list(loads).index(name)
    return loads, of_path

"""How far each measured place is from where the registration puts it."""

import csv
import io
from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import Protocol

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.io.integrity.atomic import write_whole
from physgnn.registration.inference.heavy_tails import OUTLIER_WEIGHT
from physgnn.registration.inference.rows import MeasuredRows


class Labelled(Protocol):
    """What was measured of some kind, such as places of pairs or of the bone."""

    @property
    def kind(self) -> str: ...  # noqa: D102
    @property
    def labels(self) -> tuple[str, ...]: ...  # noqa: D102
    @property
    def measured(self) -> FloatArray: ...  # noqa: D102


@dataclass(frozen=True)
class Misfit:
    """One measured place.

    Attributes
    ----------
    kind : str
        Of the measurement, such as "pairs".
    label : str
        Its name in what was read, or its number.
    x_mm, y_mm, z_mm : float
        Where it was measured, without the offset that points of the bone tell of.
    distance_mm : float
        From where the registration puts it; of a surface, across it.
    weight : float
        How far it was trusted: about 1 if it fits, near 0 if the rest contradicts it.
    """

    kind: str
    label: str
    x_mm: float
    y_mm: float
    z_mm: float
    distance_mm: float
    weight: float

    @property
    def is_outlier(self) -> bool:
        """Whether the rest contradicts it."""
        return self.weight < OUTLIER_WEIGHT

    def __str__(self) -> str:
        return f"{self.kind} '{self.label}': {self.distance_mm:.1f} mm off"


def misfits_of(
    measured: Sequence[Labelled],
    rows: MeasuredRows,
    misfit: FloatArray,
    weights: FloatArray,
) -> tuple[Misfit, ...]:
    """Return the misfit of every place in the order they were given.

    Parameters
    ----------
    measured : sequence of Labelled
        Everything measured.
    rows : MeasuredRows
        Of these.
    misfit : (m,) array
        Of every datum, over its noise.
    weights : (n,) array
        Of every place.
    """
    found, first, place = [], 0, 0
    lengths = misfit * rows.noise
    for one, (n, k) in zip(measured, rows.blocks, strict=True):
        away = np.linalg.norm(lengths[first : first + n * k].reshape(n, k), axis=1)
        for label, where, distance, weight in zip(
            one.labels, one.measured, away, weights[place : place + n], strict=True
        ):
            x, y, z = where.tolist()
            found.append(
                Misfit(one.kind, label, x, y, z, float(distance), float(weight))
            )
        first, place = first + n * k, place + n
    return tuple(found)


def write_misfits(path: str | Path, misfits: Sequence[Misfit]) -> None:
    """Write a CSV of a row a place, whole or not at all.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in fields(Misfit)])
    for one in misfits:
        writer.writerow(
            f"{value:.4f}" if isinstance(value, float) else value
            for value in astuple(one)
        )
    write_whole(Path(path), text.getvalue())


def rms_length(lengths: FloatArray, kept: BoolArray, rows: MeasuredRows) -> float:
    """Root mean square length of the rows of places that are kept, mm."""
    shares = np.concatenate([np.full(n * k, 1.0 / k) for n, k in rows.blocks])
    count = float(shares[kept].sum())
    return float(np.sqrt((lengths[kept] ** 2).sum() / count)) if count else np.nan

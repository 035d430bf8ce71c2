"""Everything measured as rows of one linear system, each over its noise."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.registration.inference.gaussian import Blocks
from physgnn.registration.measurements.observation import Measurement, Observation
from physgnn.registration.tangent_response import Fields


@dataclass(frozen=True, eq=False)
class Modes:
    """Of which families the coefficients are.

    Attributes
    ----------
    family : (r,) integer array
        Of those whose variances are chosen.
    known : (q,) array
        Variances of the coefficients that follow, which are known beforehand.
    least_mm : float
        A family is not thought to be smaller than this beforehand: the noise.
    most : (n_families,) array or None
        Standard deviations that the chosen ones do not exceed; None where there are no
        such.
    """

    family: IntArray
    known: FloatArray
    least_mm: float
    most: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class MeasuredRows:
    """A w = d + noise of standard deviation 1.

    Attributes
    ----------
    A : (m, r) array
        What each coefficient does to each datum.
    d : (m,) array
        The data over their noise.
    noise : (m,) array
        Of each datum, mm.
    blocks : tuple of (n, k)
        Places and components of each measurement.
    """

    A: FloatArray
    d: FloatArray
    noise: FloatArray
    blocks: Blocks

    @property
    def n_places(self) -> int:
        """How many places were measured."""
        return sum(n for n, _ in self.blocks)

    def spread(self, of_places: FloatArray) -> FloatArray:
        """Return values of places as values of their data, (m,)."""
        return spread(of_places, self.blocks)

    def typical_mm(self, weights: FloatArray) -> float:
        """Return the weighted root mean square of the kind that is largest, mm."""
        square = self.spread(weights) * (self.d * self.noise) ** 2
        each = np.cumsum([0, *(n * k for n, k in self.blocks)])
        total = np.add.reduceat(square, each[:-1])
        share = np.add.reduceat(self.spread(weights), each[:-1])
        return float(np.sqrt((total / share).max()))

    def with_columns(self, columns: FloatArray) -> "MeasuredRows":
        """Return the rows with further columns, (m, q), in mm."""
        A = np.concatenate([self.A, columns / self.noise[:, None]], axis=1)
        return MeasuredRows(A, self.d, self.noise, self.blocks)


def spread(of_places: FloatArray, blocks: Blocks) -> FloatArray:
    """Return values of places as values of their data."""
    sizes = np.concatenate([np.full(n, k) for n, k in blocks])
    return np.repeat(of_places, sizes)


def rows_of(
    seen: Sequence[Observation],
    noises: Sequence[float],
    response: Fields,
    backward: FloatArray,
) -> MeasuredRows:
    """Return what observations say of the coefficients of load modes.

    Parameters
    ----------
    seen : sequence of Observation
        About the present state.
    noises : sequence of float
        Of each observation, mm.
    response : (r, n_points, 3) array
        What each mode does, mm.
    backward : (n_points, 3) array
        What remains to be gone without any load, mm.
    """
    A, d = [], []
    for one in seen:
        A.append(_components(one, response))
        d.append((one.missing - one.of(backward)).ravel())
    blocks = tuple(one.missing.shape for one in seen)
    sizes = [n * k for n, k in blocks]
    noise = np.repeat(np.asarray(noises, dtype=np.float64), sizes)
    return MeasuredRows(
        np.concatenate(A) / noise[:, None], np.concatenate(d) / noise, noise, blocks
    )


def rigid_columns(
    seen: Sequence[Observation], measured: Sequence[Measurement]
) -> tuple[FloatArray, FloatArray]:
    """Return what a rigid offset does to each datum, and its centre.

    A navigation that is off by a translation t and a small rotation ω about the centre
    c finds a point at y + t + ω × (y − c).

    Returns
    -------
    columns : (m, 6) array
        For t in mm and ω in radians.
    centre : (3,) array
        The middle of everything measured, mm.
    """
    centre = middle_of(measured)
    parts = [
        turning(one.axes, where.measured - centre)
        for one, where in zip(seen, measured, strict=True)
    ]
    return np.concatenate(parts), centre


def middle_of(measured: Sequence[Measurement]) -> FloatArray:
    """Return the middle of everything measured, (3,), mm."""
    middle: FloatArray = np.concatenate([one.measured for one in measured]).mean(axis=0)
    return middle


def turning(axes: FloatArray, arms: FloatArray) -> FloatArray:
    """Return what a translation and a small rotation do along axes.

    Parameters
    ----------
    axes : (n, k, 3) array
        The directions that count at each place.
    arms : (n, 3) array
        Of each place from the centre of the rotation, mm.

    Returns
    -------
    (n k, 6) array
        For a translation in mm and a rotation in radians.
    """
    along = np.broadcast_to(arms[:, None, :], axes.shape)
    turns = np.cross(along, axes)  # a · (ω × r) = ω · (r × a)
    return np.concatenate([axes, turns], axis=2).reshape(-1, 6)


def _components(seen: Observation, response: Fields) -> FloatArray:
    """Return what each mode does to each measured component, A = P K⁻¹ B."""
    rows = [seen.of(u.astype(np.float64)).ravel() for u in response]
    return np.array(rows).T

"""Point sets by rule: a craniotomy in a few lines of TOML.

A rule is chosen by its kind and selects among the points of the outer surface::

    [point_sets.fixed]
    kind = "half_space"
    rotation_deg = [20, 0]
    offset_mm = [80, 90, 120]
    keep = "<"
    limit_mm = 265

    [point_sets.loaded]
    kind = "nearest"
    point_mm = [62, 129, 150]
    count = 80
"""

import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import BoolArray, FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_surface
from physgnn.geometry.surface import Surface
from physgnn.geometry.tetmesh import TetMesh

Mask = BoolArray

COMPARISONS: Mapping[str, Callable[[FloatArray, float], Mask]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}


@dataclass(frozen=True)
class HalfSpace:
    """Points whose height z' compares with a limit.

    z' is the third component of Rx(a)·Ry(b)·X + p with right-handed rotations.

    Parameters
    ----------
    rotation_deg : (a, b)
        Angles about x and y in degrees.
    offset_mm : (x, y, z)
        The shift p; only its z matters to z'.
    keep : str
        ``"<"``, ``"<="``, ``">"`` or ``">="``.
    limit_mm : float
        What z' is compared with.
    """

    rotation_deg: tuple[float, float]
    offset_mm: tuple[float, float, float]
    keep: str
    limit_mm: float

    def __post_init__(self) -> None:
        _set_vector(self, "rotation_deg", 2)
        _set_vector(self, "offset_mm", 3)
        _set_number(self, "limit_mm")
        if self.keep not in COMPARISONS:
            raise InputError(
                f"keep must be one of {', '.join(COMPARISONS)} (got {self.keep!r})"
            )

    def height(self, points: FloatArray) -> FloatArray:
        """Return z' of every point, mm."""
        a, b = np.deg2rad(self.rotation_deg)
        third_row = np.array([-np.cos(a) * np.sin(b), np.sin(a), np.cos(a) * np.cos(b)])
        height: FloatArray = points @ third_row + self.offset_mm[2]
        return height

    def select(self, surface: Surface) -> IntArray:
        """Return the points of the faces whose three points all satisfy the rule."""
        compare = COMPARISONS[self.keep]
        return _whole_faces(
            surface, compare(self.height(surface.points), self.limit_mm)
        )


@dataclass(frozen=True)
class Sphere:
    """Points of the faces wholly within a radius of a centre.

    Parameters
    ----------
    centre_mm : (x, y, z)
        Centre, world axes.
    radius_mm : float
        Radius, > 0.
    """

    centre_mm: tuple[float, float, float]
    radius_mm: float

    def __post_init__(self) -> None:
        _set_vector(self, "centre_mm", 3)
        _set_number(self, "radius_mm")
        if not self.radius_mm > 0:
            raise InputError(f"radius_mm must be > 0 (got {self.radius_mm})")

    def select(self, surface: Surface) -> IntArray:
        """Return the points of the faces whose three points all lie in the sphere."""
        distance = np.linalg.norm(surface.points - self.centre_mm, axis=1)
        return _whole_faces(surface, distance <= self.radius_mm)


@dataclass(frozen=True)
class Nearest:
    """The surface points nearest to a point.

    Parameters
    ----------
    point_mm : (x, y, z)
        The point, world axes.
    count : int
        How many, ≥ 1.
    """

    point_mm: tuple[float, float, float]
    count: int

    def __post_init__(self) -> None:
        _set_vector(self, "point_mm", 3)
        if not isinstance(self.count, int) or self.count < 1:
            raise InputError(f"count must be a whole number ≥ 1 (got {self.count!r})")

    def select(self, surface: Surface) -> IntArray:
        """Return exactly `count` points, ties to the smaller index."""
        candidates = np.unique(surface.faces)
        if self.count > len(candidates):
            raise InputError(
                f"count = {self.count} exceeds the surface's {len(candidates)} points"
            )
        distance = np.linalg.norm(surface.points[candidates] - self.point_mm, axis=1)
        nearest = np.argsort(distance, kind="stable")[: self.count]
        return np.sort(candidates[nearest]).astype(np.int64)


@dataclass(frozen=True)
class Union:
    """Points that any of several rules selects.

    Parameters
    ----------
    of : sequence of rules
        The rules.
    """

    of: tuple["Rule", ...]

    def __post_init__(self) -> None:
        if not isinstance(self.of, list | tuple) or not self.of:
            raise InputError(f"of must be a list of one rule or more (got {self.of!r})")
        object.__setattr__(self, "of", tuple(self.of))

    def select(self, surface: Surface) -> IntArray:
        """Return the union, ascending."""
        return np.unique(np.concatenate([rule.select(surface) for rule in self.of]))


@dataclass(frozen=True)
class Complement:
    """Surface points that a rule does not select.

    Parameters
    ----------
    of : rule
        The rule.
    """

    of: "Rule"

    def select(self, surface: Surface) -> IntArray:
        """Return the other points of the surface, ascending."""
        rest: IntArray = np.setdiff1d(surface.faces, self.of.select(surface))
        return rest.astype(np.int64)


Rule = HalfSpace | Sphere | Nearest | Union | Complement

RULES: Mapping[str, type[Rule]] = {
    "half_space": HalfSpace,
    "sphere": Sphere,
    "nearest": Nearest,
    "union": Union,
    "complement": Complement,
}


def select(body: TetMesh | Surface, rule: Rule) -> IntArray:
    """Return the points of the outer surface that a rule selects, ascending.

    Parameters
    ----------
    body : TetMesh or Surface
        Indices in the result are those of its points.
    rule : HalfSpace, Sphere, Nearest, Union or Complement
        The rule.

    Returns
    -------
    (n_selected,) array of int64
        Point indices.

    Raises
    ------
    InputError
        If nothing is selected.
    """
    surface = boundary_surface(body) if isinstance(body, TetMesh) else body
    chosen = rule.select(surface)
    if len(chosen) == 0:
        low, high = surface.points.min(axis=0), surface.points.max(axis=0)
        raise InputError(
            f"no point of the surface satisfies {rule}; the surface spans "
            f"{low.round(1)} to {high.round(1)} mm: move or widen the rule"
        )
    return chosen


def _whole_faces(surface: Surface, inside: Mask) -> IntArray:
    chosen = surface.faces[inside[surface.faces].all(axis=1)]
    return np.unique(chosen).astype(np.int64)


def _set_vector(rule: Rule, name: str, size: int) -> None:
    try:
        value = np.asarray(getattr(rule, name), dtype=np.float64)
    except (TypeError, ValueError):
        value = np.empty(0)
    if value.shape != (size,) or not np.isfinite(value).all():
        raise InputError(
            f"{name} must be {size} finite numbers (got {getattr(rule, name)!r})"
        )
    object.__setattr__(rule, name, tuple(value.tolist()))


def _set_number(rule: Rule, name: str) -> None:
    value = getattr(rule, name)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{name} must be a number (got {value!r})")
    if not np.isfinite(value):
        raise InputError(f"{name} must be finite (got {value!r})")

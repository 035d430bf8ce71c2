"""The finite-element problem, all but the load: mesh, materials, fixed points, element.

What follows from these alone and is needed again and again, the elements and the
pattern of the tangent, is made once a body and shared by all who solve on it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import IntArray
from physgnn.errors import InputError
from physgnn.geometry.array_checks import checked_indices
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.elements.tangent import Pattern, make_pattern
from physgnn.mechanics.elements.tet4 import (
    DEFAULT_ELEMENT,
    Elements,
    check_materials,
    checked_element,
    make_elements,
)
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.support import check_held


@dataclass(frozen=True, eq=False, init=False)
class Body:
    """A mesh, what it is made of, and where it is held.

    Parameters
    ----------
    mesh : TetMesh
        The mesh.
    materials : mapping of int to Material
        The material of every region the mesh has.
    fixed : str or integer array
        Points that cannot move: the name of a point set, or indices.
    element : str
        "tet4", linear tetrahedra as published, or "tet4-averaged", which do not lock
        as ν nears 0.5 (`physgnn.mechanics.elements.averaged_pressure`).
    factors : Path, optional
        Folder where the factor of a large body is stored from run to run. It may be
        deleted at any time.

    Attributes
    ----------
    fixed : (n_fixed,) int64 array
        Indices of the fixed points, sorted.

    Raises
    ------
    InputError
        If a region has no material, a law or the element is unknown, a fixed point is
        not in the mesh, or the fixed points leave a part of the mesh free to move.
    """

    mesh: TetMesh
    materials: Mapping[int, Material]
    fixed: IntArray
    element: str
    factors: Path | None

    def __init__(
        self,
        mesh: TetMesh,
        materials: Mapping[int, Material],
        fixed: str | IntArray = "fixed",
        *,
        element: str = DEFAULT_ELEMENT,
        factors: Path | None = None,
    ) -> None:
        check_materials(mesh, materials)
        for name, value in (
            ("mesh", mesh),
            ("materials", materials),
            ("fixed", _indices(mesh, fixed)),
            ("element", checked_element(element)),
            ("factors", factors),
        ):
            object.__setattr__(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        # A copy, or another process, makes its own elements and pattern.
        make = partial(Body, element=self.element, factors=self.factors)
        return make, (self.mesh, self.materials, self.fixed)

    @cached_property
    def elements(self) -> Elements:
        """Gradients, volumes and laws of all cells, made when first asked for."""
        return make_elements(self.mesh, self.materials, self.element)

    @cached_property
    def pattern(self) -> Pattern:
        """The tangent's pattern over the free points, made when first asked for."""
        return self.pattern_holding(self.fixed)

    def pattern_holding(self, held: IntArray) -> Pattern:
        """Return the tangent's pattern with these points held, not the fixed ones."""
        averaging = self.elements.averaging
        return make_pattern(self.mesh.cells, self.mesh.n_points, held, averaging)


def _indices(mesh: TetMesh, fixed: str | IntArray) -> IntArray:
    """Return the fixed points' indices, sorted; InputError if they cannot serve."""
    points = np.unique(
        mesh.point_set(fixed)
        if isinstance(fixed, str)
        else checked_indices(fixed, mesh.n_points, "fixed points")
    )
    if len(points) < 3:
        raise InputError(
            f"at least three points must be fixed (got {len(points)}): "
            "otherwise the body floats away"
        )
    check_held(mesh, points)
    return points

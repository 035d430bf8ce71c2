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
        If a region has no material, a law or the element is unknown, or a fixed point
        is not in the mesh.

    Notes
    -----
    A load may hold points too, by prescribed displacements. Whether fixed points and
    load together hold the body is therefore asked where both are known, in
    `pattern_under`.
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
        """The tangent's pattern over the free points, made when first asked for.

        Raises
        ------
        InputError
            If the fixed points alone leave a part of the mesh free to move.
        """
        check_held(self.mesh, self.fixed)
        return self.pattern_holding(self.fixed)

    def pattern_under(self, held: IntArray) -> Pattern:
        """Return the tangent's pattern under a load that holds these points too.

        Parameters
        ----------
        held : (n_held,) integer array
            Points with prescribed displacement; none for most loads.

        Raises
        ------
        InputError
            If fixed and held points together leave a part of the mesh free to move.
        """
        if len(held) == 0:
            return self.pattern
        at_rest = np.union1d(self.fixed, held)
        check_held(self.mesh, at_rest)
        return self.pattern_holding(at_rest)

    def pattern_holding(self, held: IntArray) -> Pattern:
        """Return the tangent's pattern with these points held, not the fixed ones.

        What else holds the body, such as springs, is for the caller to know.
        """
        averaging = self.elements.averaging
        return make_pattern(self.mesh.cells, self.mesh.n_points, held, averaging)


def _indices(mesh: TetMesh, fixed: str | IntArray) -> IntArray:
    """Return the fixed points' indices, sorted; InputError if they cannot serve."""
    return np.unique(
        mesh.point_set(fixed)
        if isinstance(fixed, str)
        else checked_indices(fixed, mesh.n_points, "fixed points")
    )

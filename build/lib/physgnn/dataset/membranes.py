"""Falx and tentorium as part of a body's support: held, elastic, or left out."""

from dataclasses import dataclass, replace

import numpy as np

from physgnn.arrays import IntArray
from physgnn.choices import MembraneSupport
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.springs import membrane_springs

NAMES = ("falx", "tentorium")


@dataclass(frozen=True)
class Membranes:
    """How the sheets between the parts of a brain act.

    Attributes
    ----------
    falx, tentorium : MembraneSupport
        Of the point set of that name.
    stiffness_pa_per_mm : float
        Of elastic ones: pressure for a displacement of 1 mm. The default resists as
        much as some 3 mm of the published brain do; there is no measurement.

    Raises
    ------
    InputError
        If a support has no such name or the stiffness is not positive.
    """

    falx: MembraneSupport = MembraneSupport.LEFT_OUT
    tentorium: MembraneSupport = MembraneSupport.LEFT_OUT
    stiffness_pa_per_mm: float = 1000.0

    def __post_init__(self) -> None:
        for name in NAMES:
            value = getattr(self, name)
            if value not in list(MembraneSupport):
                raise InputError(
                    f"{name} must be one of {', '.join(MembraneSupport)} (got {value})"
                )
            object.__setattr__(self, name, MembraneSupport(value))
        if not 0.0 < self.stiffness_pa_per_mm < np.inf:
            raise InputError(
                f"stiffness_pa_per_mm must be > 0 (got {self.stiffness_pa_per_mm})"
            )

    def named(self, support: MembraneSupport) -> list[str]:
        """Return the membranes with a support."""
        return [name for name in NAMES if getattr(self, name) == support]

    def holding(self, mesh: TetMesh) -> TetMesh:
        """Return the mesh with held membranes among its fixed points.

        Raises
        ------
        InputError
            If the mesh lacks a membrane that is not left out, or nothing else is
            loaded.
        """
        self.check_against(mesh)
        held = self.named(MembraneSupport.HELD)
        if not held:
            return mesh
        fixed = [mesh.point_set("fixed"), *(mesh.point_set(name) for name in held)]
        sets = {"fixed": np.unique(np.concatenate(fixed))}
        if "loaded" in mesh.point_sets:
            sets["loaded"] = np.setdiff1d(mesh.point_set("loaded"), sets["fixed"])
        return mesh.with_point_sets(**sets)

    def check_against(self, mesh: TetMesh) -> None:
        """Raise InputError if the mesh lacks a membrane that is not left out."""
        for name in NAMES:
            if getattr(self, name) != MembraneSupport.LEFT_OUT and (
                name not in mesh.point_sets
            ):
                raise InputError(
                    f"the mesh has no point set '{name}' to hold or to spring: mesh a "
                    "label map that tells left from right and cerebrum from "
                    f"cerebellum, or leave the {name} out"
                )

    def points(
        self, mesh: TetMesh, support: MembraneSupport, besides: IntArray
    ) -> IntArray:
        """Return the points of all membranes with a support that are not `besides`."""
        sheets = [mesh.point_set(name) for name in self.named(support)]
        every = np.unique(np.concatenate([np.empty(0, np.int64), *sheets]))
        return np.setdiff1d(every, besides)

    def on(self, mesh: TetMesh, paths: list[LoadPath]) -> list[LoadPath]:
        """Return the load paths with the springs of elastic membranes."""
        sheet = self.points(mesh, MembraneSupport.ELASTIC, mesh.point_set("fixed"))
        if not len(sheet):
            return paths
        springs = membrane_springs(mesh, sheet, self.stiffness_pa_per_mm)
        return [replace(path, more=(*path.more, springs)) for path in paths]

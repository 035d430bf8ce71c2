"""Hyperelastic finite elements: materials, loads, equilibrium along a load path."""

from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.cell_kinematics import deformation_gradient
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.equilibrium.solver import Solver, SolverOptions, solve
from physgnn.mechanics.kernel_cache import drop_stale_kernels
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.growth import VolumeGrowth
from physgnn.mechanics.loads.paths import Load, LoadCase, LoadPath
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.loads.pressure import SurfacePressure, faces_within
from physgnn.mechanics.loads.springs import Springs, membrane_springs
from physgnn.mechanics.materials import (
    TISSUES,
    Material,
    MooneyRivlin,
    NeoHookean,
    Ogden,
)
from physgnn.mechanics.resection import remove_region

__all__ = [
    "TISSUES",
    "Body",
    "Gravity",
    "Load",
    "LoadCase",
    "LoadPath",
    "Material",
    "MooneyRivlin",
    "NeoHookean",
    "Ogden",
    "PrescribedDisplacement",
    "RestState",
    "Solution",
    "Solver",
    "SolverOptions",
    "Springs",
    "Status",
    "SurfacePressure",
    "VolumeGrowth",
    "deformation_gradient",
    "faces_within",
    "membrane_springs",
    "remove_region",
    "solve",
]

drop_stale_kernels()

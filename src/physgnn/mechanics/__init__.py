"""Hyperelastic finite elements: materials, loads, equilibrium along a load path."""

from physgnn.mechanics.body import Body
from physgnn.mechanics.gravity import Gravity
from physgnn.mechanics.kernel_cache import drop_stale_kernels
from physgnn.mechanics.kinematics import deformation_gradient
from physgnn.mechanics.loads import Load, LoadCase, LoadPath
from physgnn.mechanics.materials import (
    TISSUES,
    Material,
    MooneyRivlin,
    NeoHookean,
    Ogden,
)
from physgnn.mechanics.prescribed import PrescribedDisplacement
from physgnn.mechanics.pressure import SurfacePressure, faces_within
from physgnn.mechanics.resection import remove_region
from physgnn.mechanics.rest_state import RestState
from physgnn.mechanics.solution import Solution, Status
from physgnn.mechanics.solver import Solver, SolverOptions, solve

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
    "Status",
    "SurfacePressure",
    "deformation_gradient",
    "faces_within",
    "remove_region",
    "solve",
]

drop_stale_kernels()

"""Hyperelastic finite elements: materials, loads, equilibrium along a load path."""

from physgnn.mechanics.element import deformation_gradient
from physgnn.mechanics.kernel_cache import drop_stale_kernels
from physgnn.mechanics.loads import LoadCase, LoadPath
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.rest_state import RestState
from physgnn.mechanics.solution import Solution, Status
from physgnn.mechanics.solver import Solver, SolverOptions, solve

__all__ = [
    "LoadCase",
    "LoadPath",
    "NeoHookean",
    "RestState",
    "Solution",
    "Solver",
    "SolverOptions",
    "Status",
    "deformation_gradient",
    "solve",
]

drop_stale_kernels()

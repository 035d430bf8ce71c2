"""The names that `physgnn.mechanics` exports, and where each is."""

from .body import Body as Body
from .elements.cell_kinematics import deformation_gradient as deformation_gradient
from .equilibrium.solution import Solution as Solution
from .equilibrium.solution import Status as Status
from .equilibrium.solver import Solver as Solver
from .equilibrium.solver import SolverOptions as SolverOptions
from .equilibrium.solver import solve as solve
from .linear.linear_elasticity import RestState as RestState
from .loads.gravity import Gravity as Gravity
from .loads.growth import VolumeGrowth as VolumeGrowth
from .loads.paths import Load as Load
from .loads.paths import LoadCase as LoadCase
from .loads.paths import LoadPath as LoadPath
from .loads.prescribed import PrescribedDisplacement as PrescribedDisplacement
from .loads.pressure import SurfacePressure as SurfacePressure
from .loads.pressure import faces_within as faces_within
from .loads.springs import Springs as Springs
from .loads.springs import membrane_springs as membrane_springs
from .materials import TISSUES as TISSUES
from .materials import Material as Material
from .materials import MooneyRivlin as MooneyRivlin
from .materials import NeoHookean as NeoHookean
from .materials import Ogden as Ogden
from .resection import remove_region as remove_region

__all__: list[str]

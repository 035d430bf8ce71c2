"""The names a user needs: the table of what ``physgnn`` exports."""

from .dataset import Store as Store
from .errors import InputError as InputError
from .geometry import Surface as Surface
from .geometry import TetMesh as TetMesh
from .geometry import tetrahedralize as tetrahedralize
from .io import read_mesh as read_mesh
from .io import read_surface as read_surface
from .io import write_mesh as write_mesh
from .learning.graph import Graph as Graph
from .learning.physgnn.network import PhysGNN as PhysGNN
from .learning.physgnn.published import load_published as load_published
from .mechanics import Body as Body
from .mechanics import LoadCase as LoadCase
from .mechanics import LoadPath as LoadPath
from .mechanics import NeoHookean as NeoHookean
from .mechanics import RestState as RestState
from .mechanics import Solution as Solution
from .mechanics import Solver as Solver
from .mechanics import SolverOptions as SolverOptions
from .mechanics import Status as Status
from .mechanics import solve as solve
from .prediction import Prediction as Prediction
from .prediction import Predictor as Predictor
from .stages import *  # noqa: F403 (the commands as functions)

__all__: list[str]
__version__: str

"""Real-time prediction of brain deformation: FE, graph neural networks, error bars.

The names a user needs are here, the commands among them as functions; each is imported
when first asked for, so that ``import physgnn`` costs nothing and the mechanics run
without torch.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    __version__: str

    from physgnn.dataset import Store as Store
    from physgnn.errors import InputError as InputError
    from physgnn.geometry import Surface as Surface
    from physgnn.geometry import TetMesh as TetMesh
    from physgnn.geometry import tetrahedralize as tetrahedralize
    from physgnn.io import read_mesh as read_mesh
    from physgnn.io import read_surface as read_surface
    from physgnn.io import write_mesh as write_mesh
    from physgnn.learning.graph import Graph as Graph
    from physgnn.learning.physgnn.network import PhysGNN as PhysGNN
    from physgnn.learning.physgnn.published import load_published as load_published
    from physgnn.mechanics import Body as Body
    from physgnn.mechanics import LoadCase as LoadCase
    from physgnn.mechanics import LoadPath as LoadPath
    from physgnn.mechanics import NeoHookean as NeoHookean
    from physgnn.mechanics import RestState as RestState
    from physgnn.mechanics import Solution as Solution
    from physgnn.mechanics import Solver as Solver
    from physgnn.mechanics import SolverOptions as SolverOptions
    from physgnn.mechanics import Status as Status
    from physgnn.mechanics import solve as solve
    from physgnn.prediction import Prediction as Prediction
    from physgnn.prediction import Predictor as Predictor
    from physgnn.stages import ablate as ablate
    from physgnn.stages import adapt as adapt
    from physgnn.stages import anatomies as anatomies
    from physgnn.stages import bundle as bundle
    from physgnn.stages import demo as demo
    from physgnn.stages import evaluate as evaluate
    from physgnn.stages import export as export
    from physgnn.stages import fit_material as fit_material
    from physgnn.stages import import_results as import_results
    from physgnn.stages import mesh as mesh
    from physgnn.stages import predict as predict
    from physgnn.stages import published as published
    from physgnn.stages import register as register
    from physgnn.stages import reproduce as reproduce
    from physgnn.stages import selftest as selftest
    from physgnn.stages import simulate as simulate
    from physgnn.stages import train as train
    from physgnn.stages import uncertainty as uncertainty
    from physgnn.stages import view as view
    from physgnn.stages import warp as warp

_HOME = {
    "InputError": "errors",
    "Surface": "geometry",
    "TetMesh": "geometry",
    "tetrahedralize": "geometry",
    "read_mesh": "io",
    "read_surface": "io",
    "write_mesh": "io",
    "Body": "mechanics",
    "LoadCase": "mechanics",
    "LoadPath": "mechanics",
    "NeoHookean": "mechanics",
    "RestState": "mechanics",
    "Solution": "mechanics",
    "Solver": "mechanics",
    "SolverOptions": "mechanics",
    "Status": "mechanics",
    "solve": "mechanics",
    "Store": "dataset",
    "Graph": "learning.graph",
    "PhysGNN": "learning.physgnn.network",
    "load_published": "learning.physgnn.published",
    "Prediction": "prediction",
    "Predictor": "prediction",
    # the commands: what they take and give is in files
    "ablate": "stages",
    "adapt": "stages",
    "anatomies": "stages",
    "bundle": "stages",
    "demo": "stages",
    "evaluate": "stages",
    "export": "stages",
    "fit_material": "stages",
    "import_results": "stages",
    "mesh": "stages",
    "predict": "stages",
    "published": "stages",
    "register": "stages",
    "reproduce": "stages",
    "selftest": "stages",
    "simulate": "stages",
    "train": "stages",
    "uncertainty": "stages",
    "view": "stages",
    "warp": "stages",
}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version  # reads files: only if asked for

        return version("physgnn")
    if name not in _HOME:
        raise AttributeError(f"module 'physgnn' has no attribute '{name}'")
    return getattr(import_module(f"physgnn.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]

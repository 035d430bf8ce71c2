"""The commands as functions: paths in, files out, the same arguments.

``physgnn simulate case.vtu --preset demo -o loads.zarr`` is
``physgnn.simulate("case.vtu", "loads.zarr", preset="demo")``, and so for every command.
`COMMANDS` names the function of each; it has the command's name but for ``import``,
which Python keeps for itself. An option's name is the argument's, dashes written as
underscores, but for those in `OPTIONS`. Beside these a function may take what a
terminal shows: `CALLBACKS`.
"""

from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from physgnn.stages.ablation import ablate as ablate
    from physgnn.stages.adaptation import adapt as adapt
    from physgnn.stages.bundling import bundle as bundle
    from physgnn.stages.demonstration import demo as demo
    from physgnn.stages.evaluation import evaluate as evaluate
    from physgnn.stages.exchange import export as export
    from physgnn.stages.exchange import import_results as import_results
    from physgnn.stages.meshing import mesh as mesh
    from physgnn.stages.prediction import predict as predict
    from physgnn.stages.published_weights import published as published
    from physgnn.stages.registration import register as register
    from physgnn.stages.reproduction import reproduce as reproduce
    from physgnn.stages.simulation import simulate as simulate
    from physgnn.stages.synthetic_patients import anatomies as anatomies
    from physgnn.stages.training import train as train
    from physgnn.stages.viewing import view as view
    from physgnn.stages.warping import warp as warp

_HOME = {
    "ablate": "ablation",
    "adapt": "adaptation",
    "anatomies": "synthetic_patients",
    "bundle": "bundling",
    "demo": "demonstration",
    "evaluate": "evaluation",
    "export": "exchange",
    "import_results": "exchange",
    "mesh": "meshing",
    "predict": "prediction",
    "published": "published_weights",
    "register": "registration",
    "reproduce": "reproduction",
    "simulate": "simulation",
    "train": "training",
    "view": "viewing",
    "warp": "warping",
}

COMMANDS: Mapping[str, str] = {
    name: name for name in _HOME if name != "import_results"
} | {"import": "import_results"}
"""Command → function of this package."""
OPTIONS: Mapping[str, str] = {"as": "form", "from": "start"}
"""Option → argument, where the option's name is a keyword of Python."""
CALLBACKS = frozenset({"log", "progress", "show"})
"""Arguments without option: called with what a terminal shows."""

__all__ = sorted([*_HOME, "CALLBACKS", "COMMANDS", "OPTIONS"])


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'physgnn.stages' has no attribute '{name}'")
    return getattr(import_module(f"physgnn.stages.{_HOME[name]}"), name)

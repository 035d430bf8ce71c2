"""The commands as functions: paths in, files out, the same arguments.

``physgnn simulate case.vtu --preset demo -o loads.zarr`` is
``physgnn.simulate("case.vtu", "loads.zarr", preset="demo")``, and so for every command.
`COMMANDS` names the function of each; it has the command's name, dashes written as
underscores, but for ``import``, which Python keeps for itself. An option's name is the
argument's in the same way, but for those in `OPTIONS`. Beside these a function may take
what a terminal shows: `CALLBACKS`.
"""

from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from physgnn.stages.datasets.exchange import export as export
    from physgnn.stages.datasets.exchange import import_results as import_results
    from physgnn.stages.datasets.simulation import simulate as simulate
    from physgnn.stages.datasets.synthetic_patients import anatomies as anatomies
    from physgnn.stages.experiments.ablation import ablate as ablate
    from physgnn.stages.experiments.bundling import bundle as bundle
    from physgnn.stages.experiments.demonstration import demo as demo
    from physgnn.stages.experiments.installation import selftest as selftest
    from physgnn.stages.experiments.reproduction import reproduce as reproduce
    from physgnn.stages.materials.fitting import fit_material as fit_material
    from physgnn.stages.networks.evaluation import evaluate as evaluate
    from physgnn.stages.networks.published_weights import published as published
    from physgnn.stages.networks.training import train as train
    from physgnn.stages.patient.adaptation import adapt as adapt
    from physgnn.stages.patient.meshing import mesh as mesh
    from physgnn.stages.patient.prediction import predict as predict
    from physgnn.stages.patient.registration import register as register
    from physgnn.stages.patient.uncertainty import uncertainty as uncertainty
    from physgnn.stages.patient.viewing import view as view
    from physgnn.stages.patient.warping import warp as warp

_HOME = {
    "ablate": "experiments.ablation",
    "adapt": "patient.adaptation",
    "anatomies": "datasets.synthetic_patients",
    "bundle": "experiments.bundling",
    "demo": "experiments.demonstration",
    "evaluate": "networks.evaluation",
    "export": "datasets.exchange",
    "fit_material": "materials.fitting",
    "import_results": "datasets.exchange",
    "mesh": "patient.meshing",
    "predict": "patient.prediction",
    "published": "networks.published_weights",
    "register": "patient.registration",
    "reproduce": "experiments.reproduction",
    "selftest": "experiments.installation",
    "simulate": "datasets.simulation",
    "train": "networks.training",
    "uncertainty": "patient.uncertainty",
    "view": "patient.viewing",
    "warp": "patient.warping",
}

COMMANDS: Mapping[str, str] = {
    name.replace("_", "-"): name for name in _HOME if name != "import_results"
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

"""The steps from surfaces to a prediction: one function behind each command."""

from physgnn.stages.meshing import mesh_surfaces
from physgnn.stages.prediction import predict
from physgnn.stages.published import published_difference
from physgnn.stages.simulation import command_line, simulate
from physgnn.stages.training import store_of, train

__all__ = [
    "command_line",
    "mesh_surfaces",
    "predict",
    "published_difference",
    "simulate",
    "store_of",
    "train",
]

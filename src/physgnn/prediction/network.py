"""What a predictor asks of a trained model: answers, and the equilibria it carries."""

from collections.abc import Callable, Iterator

import numpy as np
import torch

from physgnn.learning.graph import graph_of
from physgnn.learning.interface import Model
from physgnn.learning.lifted import LiftedModel, body_axes
from physgnn.learning.reduced import ReducedModel
from physgnn.mechanics.element import internal_force
from physgnn.mechanics.known_states import KnownState, NearestKnown
from physgnn.mechanics.loads import LoadCase
from physgnn.prediction.prediction import Answer, FloatArray

TINY_N = 1e-6  # leaves the rest state the nearest


def nearest_known(model: Model) -> NearestKnown | None:
    """Return how to find the nearest equilibrium that a model carries with it."""
    if isinstance(model, ReducedModel):
        return model.nearest_known
    if not isinstance(model, LiftedModel):
        return None
    axes = body_axes(model.body.mesh)

    def known(force: FloatArray) -> KnownState:
        about = model.perturbation.about(force @ axes.T)
        return KnownState(about.u @ axes, lambda f: about.solve(f @ axes.T) @ axes)

    return known


def quick_linear(model: Model) -> Answer | None:
    """Return the linear answer that a model keeps for itself, if it does."""
    return model.linear if isinstance(model, LiftedModel) else None


def soundness(model: Model) -> Callable[[LoadCase], bool] | None:
    """Return how a model tells that it has no sound answer to a load, if it can."""
    return model.is_sound if isinstance(model, ReducedModel) else None


def first_cases(model: Model) -> Iterator[LoadCase]:
    """Yield the load each anchor is in equilibrium with, and a tiny one."""
    body = model.body
    free = np.setdiff1d(np.arange(body.mesh.n_points), body.fixed)
    yield LoadCase(free[:1], np.full((1, 3), TINY_N))
    if not isinstance(model, LiftedModel):
        return
    states = model.anchor_states.cpu().numpy().astype(np.float64)
    for state in states @ body_axes(body.mesh):
        force, inverted = internal_force(body.elements, state)
        if inverted < 0 and force[free].any():
            yield LoadCase(free, force[free])


def network_answer(model: Model, *, device: str = "cpu") -> Answer:
    """Return a model as a function from load case to displacement."""
    model = model.to(device).eval()
    graph = graph_of(model.body).to(device)

    @torch.inference_mode()
    def answer(load_case: LoadCase) -> FloatArray:
        inputs = model.encode(load_case).to(device).unsqueeze(0)
        displacement: FloatArray = model(inputs, graph)[0].cpu().numpy()
        return model.refine(load_case, displacement.astype(np.float64))

    return answer

"""The methods there are: one row each, and the way to name one of your own.

What a method owes is written in :mod:`physgnn.learning.surrogate`.
"""

import importlib
import inspect
import sys
from collections.abc import Mapping
from numbers import Number
from pathlib import Path
from typing import Any

from physgnn.errors import InputError
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics.body import Body

MODELS: Mapping[str, str] = {
    "zero": "physgnn.learning.baselines.zero:Zero",
    "linear": "physgnn.learning.baselines.linear:Linear",
    "interpolation": (
        "physgnn.learning.baselines.level_interpolation:LevelInterpolation"
    ),
    "linear-regression": (
        "physgnn.learning.classical.linear_regression:LinearRegression"
    ),
    "decision-tree": "physgnn.learning.classical.regression_trees:DecisionTree",
    "random-forest": "physgnn.learning.classical.regression_trees:RandomForest",
    "svr": "physgnn.learning.classical.support_vector:SupportVectors",
    "gpr": "physgnn.learning.classical.gaussian_process:GaussianProcess",
    "rbf": "physgnn.learning.classical.radial_basis:RadialBasis",
    "pod-network": "physgnn.learning.classical.pod_network:PODNetwork",
    "extra-trees": "physgnn.learning.classical.regression_trees:ExtraTrees",
    "mlp": "physgnn.learning.classical.nodal_network:NodalNetwork",
    "galerkin": "physgnn.learning.reduced_order.pod_galerkin:GalerkinModel",
    "reduced": "physgnn.learning.reduced_order.local_expansion:ReducedModel",
    "finite-element": "physgnn.learning.baselines.finite_element:FiniteElement",
    "meshgraphnet": (
        "physgnn.learning.mesh_networks.meshgraphnet_model:MeshGraphNetModel"
    ),
    "transolver": "physgnn.learning.mesh_networks.transolver_model:TransolverModel",
    "cnn": "physgnn.learning.grid_networks.cnn_model:CNNModel",
    "lifted": "physgnn.learning.lifted.model:LiftedModel",
    "physgnn": "physgnn.learning.physgnn.model:PhysGNNModel",
}
"""From a method's name to its class, which is imported when first asked for."""

EARLIER_NAMES: Mapping[str, str] = {
    "level_interpolation": "interpolation",
    "pod_network": "pod-network",
    "extra_trees": "extra-trees",
    "nodal_network": "mlp",
    "finite_element": "finite-element",
}
"""From what a method was called before to its name now: files may have either."""

EARLIER_OPTIONS: Mapping[str, str] = {
    "reach": "k_hops",
    "reach_from_rest": "k_hops_from_rest",
    "settle": "submodel_hops",
    "together": "nearest_anchors",
    "modes": "pod_modes",
}
"""What options of the methods above were called before, and are now."""

OPTIONS_BEFORE: Mapping[str, Mapping[str, Any]] = {
    "lifted": {
        "response_modes": 0,
        "pod_modes": 16,
        "any_axes": False,
        "exponential": False,
        "imbalance": False,
        "relaxed_patches": 0,
    },
}
"""Options that came later or had another default: what records without them mean."""

OTHER_LABELS: Mapping[str, Mapping[str, Any]] = {
    "lifted": {"submodel_hops": 0, "relaxed_patches": 0},
}
"""Defaults where a dataset's displacements are no equilibria of its elements."""


def method_name(name: str) -> str:
    """Return what a method is called now."""
    return EARLIER_NAMES.get(name, name)


def method_options(name: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return a method's options by the names they have now.

    The options of a method that is no row of ``MODELS`` are its own affair.

    Raises
    ------
    InputError
        If an option is given by both of its names.
    """
    if method_name(name) not in MODELS:
        return dict(options)
    renamed: dict[str, Any] = {}
    for option, value in options.items():
        now = EARLIER_OPTIONS.get(option, option)
        if now in renamed:
            raise InputError(
                f"option '{now}' of model '{name}' is given twice: '{option}' is the "
                "same by another name; leave one out"
            )
        renamed[now] = value
    return renamed


def recorded_options(name: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return a record's options, and what leaving one out meant when it was written."""
    before = OPTIONS_BEFORE.get(method_name(name), {})
    return {**before, **method_options(name, options)}


def build_model(name: str, body: Body, **options: Any) -> Surrogate:
    """Return a surrogate that is not fitted yet.

    Parameters
    ----------
    name : str
        A row of ``MODELS``, or ``module:Class``.
    body : Body
        What it's made for.
    **options
        The method's own keyword arguments, such as ``configuration=3``.

    Raises
    ------
    InputError
        If there's no such method, the method has no such option, or doesn't know the
        body's elements.
    """
    options, method = resolved_options(name, options), model_class(name)
    if body.element not in method.elements:
        raise InputError(
            f"model '{name}' knows {', '.join(method.elements)} elements (got "
            f"{body.element}): train model lifted, or simulate with those"
        )
    return method(body, **options)


def resolved_options(name: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return all options of a method: those given, and the defaults of the others.

    Options may have earlier names; those returned have the present ones.

    Raises
    ------
    InputError
        If there's no such method, or the method has no such option, or one is text,
        a number, or true or false, where its default is another of these.
    """
    parameters = inspect.signature(model_class(name)).parameters.values()
    known = {p.name: p.default for p in parameters if p.kind is p.KEYWORD_ONLY}
    now = method_options(name, options)
    unknown = sorted(
        k for k in options if not {*method_options(name, {k: 0})} & {*known}
    )
    if unknown:
        raise InputError(
            f"model '{name}' has no option '{unknown[0]}' "
            f"(it has: {', '.join(known) or 'none'})"
        )
    for option, value in now.items():
        expected, came = _kind(known[option]), _kind(value)
        if expected and came != expected:
            raise InputError(
                f"option '{option}' of model '{name}' must be {expected}, such as "
                f"{known[option]!r} (got {value!r})"
            )
    return {**known, **now}


def _kind(value: object) -> str:
    """Return what an option's value is; empty where any may stand for it."""
    if isinstance(value, bool):
        return "true or false"
    if isinstance(value, Number):
        return "a number"
    return "text" if isinstance(value, str) else ""


def is_model(name: str) -> bool:
    """Return whether a name is a row of ``MODELS`` or reads ``module:Class``."""
    module, colon, attribute = name.partition(":")
    return method_name(name) in MODELS or bool(module and colon and attribute)


def model_class(name: str) -> type[Surrogate]:
    """Return the class of a method.

    Parameters
    ----------
    name : str
        A row of ``MODELS``, or ``module:Class``. The module is looked for as every
        import is, and at last in the working directory.

    Raises
    ------
    InputError
        If there's no such method, or it cannot be imported.
    """
    if not is_model(name):
        raise InputError(
            f"no model '{name}' (there are: {', '.join(sorted(MODELS))}; name one of "
            "your own as module:Class)"
        )
    name = method_name(name)
    module, _, attribute = MODELS.get(name, name).partition(":")
    if name not in MODELS and str(Path.cwd()) not in sys.path:
        sys.path.append(str(Path.cwd()))
    try:
        found = getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError) as error:
        raise InputError(
            f"model '{name}' cannot be imported ({error}): name module:Class, with the "
            "module on PYTHONPATH or in the working directory"
        ) from error
    if not (isinstance(found, type) and issubclass(found, Surrogate)):
        raise InputError(
            f"model '{name}' must be a class derived from "
            f"physgnn.learning.surrogate.Surrogate (got {found!r})"
        )
    return found

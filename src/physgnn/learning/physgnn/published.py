"""The published weights, read into the network they belong to."""

import re
from collections.abc import Mapping
from pathlib import Path

import torch
from torch import Tensor

from physgnn.errors import InputError
from physgnn.learning.physgnn.architecture import Architecture
from physgnn.learning.physgnn.network import PhysGNN

_LAYER_NAMES = (
    (r"conv(\d)\.(?:lin_l|lin_rel)\.", "convolutions.{}.neighbours."),
    (r"conv(\d)\.(?:lin_r|lin_root)\.", "convolutions.{}.root."),
    (r"active([1-6])\.", "activations.{}."),
    (r"jk(\d)\.lstm\.", "attentions.{}.lstm."),
    (r"jk(\d)\.att\.", "attentions.{}.score."),
)
_HEAD_NAMES = {"lin1.": "head.0.", "active7.": "head.1.", "lin2.": "head.3."}


def load_published(
    path: str | Path, configuration: int = 3, dataset: int = 2
) -> PhysGNN:
    """Read a published state dict, whether named by an old PyTorch Geometric or a new.

    Parameters
    ----------
    path : path
        A ``.pt`` file of plain tensors; nothing else in it is ever executed.
    configuration, dataset : int
        Which network it holds; the file doesn't say, and all twelve have the same
        shapes.

    Returns
    -------
    PhysGNN
        In evaluation mode, on the CPU.

    Raises
    ------
    InputError
        If the file is missing, isn't a state dict, or is another network's.
    """
    network = PhysGNN(Architecture(configuration, dataset))
    state = {our_name(name): value for name, value in _read(Path(path)).items()}
    expected = {name: value.shape for name, value in network.state_dict().items()}
    if {name: value.shape for name, value in state.items()} != expected:
        raise InputError(
            f"{path} doesn't hold the weights of a published PhysGNN "
            f"({sum(map(torch.Size.numel, expected.values())):,} numbers expected); "
            "check that it's the file you mean"
        )
    network.load_state_dict(state)
    return network.eval()


def _read(path: Path) -> Mapping[str, Tensor]:
    if not path.is_file():
        raise InputError(f"no file of weights at {path}")
    try:
        state = torch.load(path, map_location="cpu", weights_only=True)
    except Exception as error:  # torch documents no type for a file that isn't its own
        raise InputError(
            f"{path} isn't a PyTorch state dict of plain tensors"
        ) from error
    if not isinstance(state, Mapping) or not all(
        isinstance(value, Tensor) for value in state.values()
    ):
        raise InputError(f"{path} isn't a PyTorch state dict of plain tensors")
    return state


def our_name(name: str) -> str:
    """Return our name of a published parameter."""
    for pattern, ours in _LAYER_NAMES:
        if match := re.match(pattern, name):
            return ours.format(int(match[1]) - 1) + name[match.end() :]
    for theirs, ours in _HEAD_NAMES.items():
        if name.startswith(theirs):
            return ours + name.removeprefix(theirs)
    return name

"""How exactly the LSTMs multiply: they are nine tenths of the work."""

from collections.abc import Mapping

import torch
from torch import nn

from physgnn.errors import InputError
from physgnn.learning.physgnn.layers.jumping_knowledge import JumpingKnowledge
from physgnn.learning.physgnn.network import PhysGNN

PRECISIONS: Mapping[str, torch.dtype | None] = {
    "float32": None,
    "bfloat16": torch.bfloat16,
}


def set_precision(network: nn.Module, precision: str) -> None:
    """Choose the precision of a network's LSTMs' products; all else stays float32.

    They only say which layer matters, so rounding there shifts the answer little, in
    training as well: weights stay float32, gradients are added up in it. bfloat16 pays
    where the processor multiplies it faster (AMX, AVX-512 BF16).

    Parameters
    ----------
    network : Module
        Its :class:`JumpingKnowledge` parts are set.
    precision : {"float32", "bfloat16"}
        A row of ``PRECISIONS``.

    Raises
    ------
    InputError
        If there's no such precision, or nothing that it would change.
    """
    if precision not in PRECISIONS:
        raise InputError(
            f"precision must be one of {', '.join(PRECISIONS)} (got {precision})"
        )
    attentions = [m for m in network.modules() if isinstance(m, JumpingKnowledge)]
    if precision != "float32" and not attentions:
        raise InputError(
            f"{precision} is for the LSTMs of PhysGNN, and this model has none: leave "
            "precision at float32"
        )
    for attention in attentions:
        attention.compiled.precision = PRECISIONS[precision]
    for module in network.modules():
        if isinstance(module, PhysGNN):
            module.pruning.forget()

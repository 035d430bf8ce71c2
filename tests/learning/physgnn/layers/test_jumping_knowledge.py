import pytest
import torch

from learning.reference import JumpingKnowledge as Reference
from physgnn.learning.physgnn.layers.jumping_knowledge import JumpingKnowledge


@pytest.mark.parametrize(("width", "n_layers"), [(2, 1), (8, 2), (10, 3), (6, 5)])
def test_equals_pytorch_geometric(width: int, n_layers: int) -> None:
    torch.manual_seed(width)
    reference = Reference("lstm", width, n_layers).double()
    ours = JumpingKnowledge(width, n_layers).double()
    ours.lstm.load_state_dict(reference.lstm.state_dict())
    ours.score.load_state_dict(reference.att.state_dict())
    layers = list(torch.randn(n_layers, 20, width).double())
    ours_found = ours([layer[None] for layer in layers])[0]
    torch.testing.assert_close(ours_found, reference(layers))


def test_equal_layers_are_their_own_mean() -> None:
    layer = torch.randn(2, 7, 4)
    torch.testing.assert_close(JumpingKnowledge(4, 3)([layer] * 3), layer)


def test_other_devices_score_with_torchs_lstm_to_the_same() -> None:
    torch.manual_seed(0)
    ours = JumpingKnowledge(8, 3).double()
    layers = [torch.randn(2, 7, 8).double().requires_grad_() for _ in range(3)]
    compiled, plain = ours.compiled(layers), ours.scores(layers)
    torch.testing.assert_close(compiled, plain)
    given, towards = [*layers, *ours.parameters()], torch.randn_like(plain)
    torch.testing.assert_close(
        torch.autograd.grad(compiled, given, towards),
        torch.autograd.grad(plain, given, towards),
    )

"""PhysGNN's LSTMs on the processor, compiled: the network's one part where it pays.

Nothing outside this room knows how they work. What is here equals `torch.nn.LSTM` and a
linear layer after it, which `physgnn.learning.physgnn.layers.jumping_knowledge` uses on
other devices.
"""

from physgnn.learning.cpu.layer_scores import LayerScores as LayerScores
from physgnn.learning.cpu.layer_scores import compiled_for as compiled_for
from physgnn.learning.cpu.threads import only_side_by_side as only_side_by_side

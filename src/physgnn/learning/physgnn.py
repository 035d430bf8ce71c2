"""PhysGNN as published: six convolutions, two attentions over layers, a small head."""

from collections.abc import Mapping

from torch import Tensor, nn

from physgnn.errors import InputError
from physgnn.learning.graph import Graph
from physgnn.learning.operators import Convolution, JumpingKnowledge

N_INPUTS = 7
LAYERS_A_BLOCK = 3

# Configuration: layer types (G GraphConv, weighted edges; S SAGEConv, plain ones) and
# the aggregations (a add, m max) of the six layers on dataset 1 and on dataset 2.
# Salehi & Giannacopoulos 2022, tables 3 and 4.
CONFIGURATIONS: Mapping[int, tuple[str, str, str]] = {
    1: ("GGGSSS", "mmmmmm", "mmmmmm"),
    2: ("GGGSSS", "ammmmm", "ammmmm"),
    3: ("GGGSSS", "aammmm", "aammmm"),
    4: ("GGGSSS", "aaammm", "aaammm"),
    5: ("GGGSSS", "aaaamm", "aaaamm"),
    6: ("GGGSSS", "aaaaam", "aaaaam"),
    7: ("GGGSSS", "aaaaaa", "aaaaaa"),
    8: ("GSSSSS", "ammmmm", "aammmm"),
    9: ("GGSSSS", "ammmmm", "aammmm"),
    10: ("GGGGSS", "ammmmm", "aammmm"),
    11: ("GGGGGS", "ammmmm", "aammmm"),
    12: ("GGGGGG", "ammmmm", "aammmm"),
}
_AGGREGATION = {"a": "add", "m": "max"}


class PhysGNN(nn.Module):
    """The published network; 894,416 parameters at width 112.

    Parameters
    ----------
    configuration : int
        A row of ``CONFIGURATIONS``.
    dataset : {1, 2}
        Which of the row's aggregations.
    width : int
        Columns between layers, even.

    Raises
    ------
    InputError
        If there is no such configuration, dataset or width.
    """

    def __init__(
        self, configuration: int = 3, dataset: int = 2, width: int = 112
    ) -> None:
        super().__init__()
        _check(configuration, dataset, width)
        layers, *aggregations = CONFIGURATIONS[configuration]
        inputs = [N_INPUTS] + [width] * (len(layers) - 1)
        self.convolutions = nn.ModuleList(
            Convolution(
                n, width, weighted=layer == "G", aggregation=_AGGREGATION[letter]
            )
            for n, layer, letter in zip(
                inputs, layers, aggregations[dataset - 1], strict=True
            )
        )
        self.activations = nn.ModuleList(nn.PReLU(width) for _ in layers)
        self.attentions = nn.ModuleList(
            JumpingKnowledge(width, LAYERS_A_BLOCK) for _ in range(2)
        )
        narrow = width * 9 // 16
        self.head = nn.Sequential(
            nn.Linear(width, narrow), nn.PReLU(narrow), nn.Dropout(0.1),
            nn.Linear(narrow, 3),
        )  # fmt: skip

    def forward(self, x: Tensor, graph: Graph) -> Tensor:
        """Return displacement in mm.

        Parameters
        ----------
        x : (n_points, 7) or (batch, n_points, 7) float32 tensor
            Standardised features.
        graph : Graph
            The mesh's graph, on the same device.

        Returns
        -------
        (n_points, 3) or (batch, n_points, 3) tensor
            mm.
        """
        if x.ndim == 2:
            single: Tensor = self(x[None], graph)[0]
            return single
        graph.check_rows(x)
        for block, attention in enumerate(self.attentions):
            outputs: list[Tensor] = []
            for layer in range(block * LAYERS_A_BLOCK, (block + 1) * LAYERS_A_BLOCK):
                x = self.layer(layer, x, graph)
                outputs.append(x)
            x = attention(outputs)
        displacement: Tensor = self.head(x.flatten(0, 1)).view(*x.shape[:2], 3)
        return displacement

    def layer(self, index: int, x: Tensor, graph: Graph) -> Tensor:
        """Return one convolution's activated output, (batch, n_points, width)."""
        y = self.convolutions[index](x, graph)
        activated: Tensor = self.activations[index](y.flatten(0, 1)).view_as(y)
        return activated


def _check(configuration: int, dataset: int, width: int) -> None:
    if configuration not in CONFIGURATIONS:
        raise InputError(f"configuration must be 1…12 (got {configuration})")
    if dataset not in (1, 2):
        raise InputError(f"dataset must be 1 or 2 (got {dataset})")
    if width < 2 or width % 2:
        raise InputError(f"width must be even and positive (got {width})")

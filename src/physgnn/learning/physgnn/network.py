"""PhysGNN as published: six convolutions, two attentions over layers, a small head."""

from collections.abc import Mapping, Sequence

from torch import Tensor, nn

from physgnn.errors import InputError
from physgnn.learning.cpu import only_side_by_side
from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.convolution import Convolution
from physgnn.learning.physgnn.dropout import SampleDropout
from physgnn.learning.physgnn.jumping_knowledge import JumpingKnowledge
from physgnn.learning.physgnn.pruning import Pruning, Rest, filled

N_INPUTS = 7
LAYERS_A_BLOCK = 3
N_LAYERS = 6

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
        self.configuration, self.dataset, self.width = configuration, dataset, width
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
            nn.Linear(width, narrow), nn.PReLU(narrow), SampleDropout(0.1),
            nn.Linear(narrow, 3),
        )  # fmt: skip
        self.pruning = Pruning(N_LAYERS)

    def forward(self, x: Tensor, graph: Graph, points: Tensor | None = None) -> Tensor:
        """Return displacement in mm.

        Parameters
        ----------
        x : (n_points, 7) or (batch, n_points, 7) float32 tensor
            Standardised features.
        graph : Graph
            The mesh's graph, on the same device.
        points : (n,) tensor, optional
            Points whose displacement is wanted, each once; by default all. A third of
            them costs two thirds in training: the second attention is half of it.

        Returns
        -------
        (n, 3) or (batch, n, 3) tensor
            mm.
        """
        if x.ndim == 2:
            single: Tensor = self(x[None], graph, points)[0]
            return single
        graph.check_rows(x)
        with only_side_by_side():
            last = self.pruning.last_output(self, x, graph, points)
            if last is None:
                last = self._unpruned(x, graph, points)
            _, _, dropout, linear = self.head
            displacement: Tensor = linear(dropout(last.flatten(0, 1)))
        return displacement.view(*last.shape[:2], 3)

    def _unpruned(self, x: Tensor, graph: Graph, points: Tensor | None) -> Tensor:
        if points is None:
            return self.outputs(x, [graph] * N_LAYERS)[-1]
        rows, place = points.sort()
        last = self.outputs(x, [graph] * N_LAYERS, rows=rows)[-1]
        return last[:, place.argsort()]

    def outputs(
        self,
        x: Tensor,
        graphs: Sequence[Graph],
        rest: Rest | None = None,
        rows: Tensor | None = None,
    ) -> list[Tensor]:
        """Return the input and the output of every part, the head's first layer last.

        Parameters
        ----------
        x : (batch, n_points, 7) tensor
            Standardised features.
        graphs : six graphs
            One a layer; its rows are the points whose output is wanted.
        rest : callable, optional
            Gives the rows of outputs that a layer needs and that weren't wanted.
        rows : tensor, optional
            Which of the last layer's rows go through what follows it, ascending.

        Returns
        -------
        list of ten (batch, rows, columns) tensors
            Input, three layers, their attention, three layers, their attention, head.
        """
        found = [x]
        for block, attention in enumerate(self.attentions):
            first = block * LAYERS_A_BLOCK
            for index in range(first, first + LAYERS_A_BLOCK):
                n, place = graphs[index].n_columns, len(found) - 1
                x = found[-1][:, :n]
                if rest is not None:
                    x = filled(x, rest(place, x.shape[1], n))
                x = self.convolutions[index](x, graphs[index])
                found.append(_by_column(self.activations[index], x))
            places = range(len(found) - LAYERS_A_BLOCK, len(found))
            n = graphs[index].n_points
            layers = [found[place][:, :n] for place in places]
            others = rest and [
                rest(place, layer.shape[1], n)
                for place, layer in zip(places, layers, strict=True)
            ]
            is_last = attention is self.attentions[-1]
            found.append(attention(layers, others, rows if is_last else None))
        # Up to dropout, which differs from call to call.
        linear, activation = self.head[0], self.head[1]
        found.append(_by_column(activation, linear(found[-1])))
        return found


def _by_column(activation: nn.Module, x: Tensor) -> Tensor:
    """Apply PReLU, which takes the second dimension for the columns."""
    activated: Tensor = activation(x.flatten(0, 1))
    return activated.view_as(x)


def _check(configuration: int, dataset: int, width: int) -> None:
    if configuration not in CONFIGURATIONS:
        raise InputError(f"configuration must be 1…12 (got {configuration})")
    if dataset not in (1, 2):
        raise InputError(f"dataset must be 1 or 2 (got {dataset})")
    if width < 2 or width % 2:
        raise InputError(f"width must be even and positive (got {width})")

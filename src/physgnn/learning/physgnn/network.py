"""PhysGNN as published: six convolutions, two attentions over layers, a small head."""

from collections.abc import Sequence

from torch import Tensor, nn

from physgnn.errors import InputError
from physgnn.learning.cpu import only_side_by_side
from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.architecture import N_BLOCKS, Architecture
from physgnn.learning.physgnn.layers.convolution import Convolution
from physgnn.learning.physgnn.layers.dropout import SampleDropout
from physgnn.learning.physgnn.layers.jumping_knowledge import (
    JumpingKnowledge,
    LastLayer,
)
from physgnn.learning.physgnn.pruning import Pruning, Rest, filled

N_INPUTS = 7
PUBLISHED = Architecture()


class PhysGNN(nn.Module):
    """The published network; 894,416 parameters at width 112.

    Parameters
    ----------
    architecture : Architecture
        Its layers; by default those of configuration 3 on dataset 2.
    width : int
        Columns between layers, even.

    Raises
    ------
    InputError
        If the width is not even and positive.
    """

    def __init__(
        self, architecture: Architecture = PUBLISHED, width: int = 112
    ) -> None:
        super().__init__()
        if width < 2 or width % 2:
            raise InputError(f"width must be even and positive (got {width})")
        self.architecture, self.width = architecture, width
        inputs = [N_INPUTS] + [width] * (architecture.depth - 1)
        self.convolutions = nn.ModuleList(
            Convolution(n, width, weighted=weighted, aggregation=aggregation)
            for n, (weighted, aggregation) in zip(
                inputs, architecture.layers, strict=True
            )
        )
        self.activations = nn.ModuleList(nn.PReLU(width) for _ in inputs)
        self.attentions = nn.ModuleList(
            JumpingKnowledge(width, architecture.layers_a_block)
            if architecture.jumping_knowledge
            else LastLayer()
            for _ in range(N_BLOCKS)
        )
        narrow = width * 9 // 16
        self.head = nn.Sequential(
            nn.Linear(width, narrow), nn.PReLU(narrow), SampleDropout(0.1),
            nn.Linear(narrow, 3),
        )  # fmt: skip
        self.pruning = Pruning(architecture.depth)

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
            return self.outputs(x, [graph] * self.architecture.depth)[-1]
        rows, place = points.sort()
        last = self.outputs(x, [graph] * self.architecture.depth, rows=rows)[-1]
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
        graphs : sequence of Graph
            One a layer; its rows are the points whose output is wanted.
        rest : callable, optional
            Gives the rows of outputs that a layer needs and that weren't wanted.
        rows : tensor, optional
            Which of the last layer's rows go through what follows it, ascending.

        Returns
        -------
        list of (batch, rows, columns) tensors
            Input, half of the layers, their attention, the others, theirs, head: ten.
        """
        found, of_block = [x], self.architecture.layers_a_block
        for block, attention in enumerate(self.attentions):
            first = block * of_block
            for index in range(first, first + of_block):
                n, place = graphs[index].n_columns, len(found) - 1
                x = found[-1][:, :n]
                if rest is not None:
                    x = filled(x, rest(place, x.shape[1], n))
                x = self.convolutions[index](x, graphs[index])
                found.append(_by_column(self.activations[index], x))
            places = range(len(found) - of_block, len(found))
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

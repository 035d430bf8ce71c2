"""A trained PhysGNN as an ONNX file that needs neither this package nor torch.

Input ``features`` (n_points, 7) float32, standardised; output ``displacement_mm``
(n_points, 3). The mesh's edges are constants in the file. Pruning and compiled passes
aren't used: neighbours are gathered along padded rows, which every runtime knows.
"""

import warnings
from pathlib import Path

import torch
from torch import Tensor, nn

from physgnn.errors import InputError
from physgnn.io.integrity.atomic import whole_file
from physgnn.learning.graph import Graph, graph_of
from physgnn.learning.physgnn.layers.convolution import Convolution
from physgnn.learning.physgnn.layers.jumping_knowledge import JumpingKnowledge
from physgnn.learning.physgnn.network import PhysGNN
from physgnn.learning.runs.checkpoint import Checkpoint

OPSET = 18


def export_onnx(run: str | Path, path: str | Path) -> None:
    """Write a run's network as ONNX, whole or not at all.

    Parameters
    ----------
    run : path
        Folder of a trained PhysGNN.
    path : path
        The file.

    Raises
    ------
    InputError
        If the run is of another model, or the exporter isn't installed.
    """
    model = Checkpoint.load(run).model
    network = getattr(model, "network", None)
    if not isinstance(network, PhysGNN):
        raise InputError(
            f"only PhysGNN can be exported to ONNX: {run} needs more than a network"
        )
    write_onnx(network, graph_of(model.body), path)


def write_onnx(network: PhysGNN, graph: Graph, path: str | Path) -> None:
    """Write a network on a mesh's graph as ONNX, whole or not at all.

    Raises
    ------
    InputError
        If the exporter isn't installed.
    """
    with whole_file(Path(path)) as part, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the exporter's, of its own parts
        try:
            torch.onnx.export(
                PlainPhysGNN(network, graph),
                (torch.zeros(graph.n_points, 7),),
                str(part),
                input_names=["features"],
                output_names=["displacement_mm"],
                opset_version=OPSET,
                dynamo=True,
                external_data=False,
                verbose=False,
            )
        except ImportError as error:
            raise InputError(
                "ONNX export needs onnx and onnxscript: pip install 'physgnn[onnx]'"
            ) from error


class PlainPhysGNN(nn.Module):
    """The same network out of operators that every runtime has, for one sample.

    Parameters
    ----------
    network : PhysGNN
        Its weights are shared.
    graph : Graph
        The mesh's.
    """

    neighbour: Tensor
    weight: Tensor
    there: Tensor

    def __init__(self, network: PhysGNN, graph: Graph) -> None:
        super().__init__()
        self.network = network.eval()
        neighbour, weight, there = _padded(graph)
        self.register_buffer("neighbour", neighbour)
        self.register_buffer("weight", weight)
        self.register_buffer("there", there)

    def forward(self, x: Tensor) -> Tensor:
        """Return displacement in mm, (n_points, 3), for features (n_points, 7)."""
        network = self.network
        layers = list(zip(network.convolutions, network.activations, strict=True))
        of_block = network.architecture.layers_a_block
        for block, attention in enumerate(network.attentions):
            first, found = block * of_block, []
            for convolution, activation in layers[first : first + of_block]:
                assert isinstance(convolution, Convolution)
                x = activation(self._convolve(convolution, x))
                found.append(x)
            if isinstance(attention, JumpingKnowledge):
                x = _attend(attention, found)
        displacement: Tensor = network.head(x)
        return displacement

    def _convolve(self, convolution: Convolution, x: Tensor) -> Tensor:
        message = _aggregate(self, convolution, x)
        output: Tensor = convolution.neighbours(message) + convolution.root(x)
        return output


def _aggregate(plain: PlainPhysGNN, convolution: Convolution, x: Tensor) -> Tensor:
    """Walk along the padded rows: memory stays that of one column of neighbours."""
    total: Tensor | None = None
    for column in range(plain.neighbour.shape[1]):
        values = x[plain.neighbour[:, column]]
        there = plain.there[:, column, None]
        if convolution.weighted:
            values = values * plain.weight[:, column, None]
        if convolution.aggregation == "add":
            values = values * there
            total = values if total is None else total + values
        elif total is None:
            total = values  # every point has a first neighbour
        else:
            total = torch.maximum(total, torch.where(there > 0, values, total))
    assert total is not None
    return total


def _attend(attention: JumpingKnowledge, layers: list[Tensor]) -> Tensor:
    stacked = torch.stack(layers)  # (steps, n_points, width)
    hidden, _ = attention.lstm(stacked)
    share = torch.softmax(attention.score(hidden), dim=0)
    return (stacked * share).sum(dim=0)


def _padded(graph: Graph) -> tuple[Tensor, Tensor, Tensor]:
    """Return neighbours, weights and whether they're there, (n_points, most)."""
    count = graph.row_start.diff()
    if int(count.min()) == 0:
        raise InputError("a point of the mesh belongs to no cell: mesh again")
    shape = (graph.n_points, int(count.max()))
    place = torch.arange(graph.n_edges) - graph.row_start[graph.row]
    neighbour = torch.zeros(shape, dtype=torch.int64)
    weight, there = torch.zeros(shape), torch.zeros(shape)
    neighbour[graph.row, place] = graph.column
    weight[graph.row, place] = graph.weight
    there[graph.row, place] = 1.0
    return neighbour, weight, there

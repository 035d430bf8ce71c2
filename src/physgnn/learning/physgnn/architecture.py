"""Which layers the published network has: configurations, and what was left out."""

from collections.abc import Mapping
from dataclasses import dataclass

from physgnn.errors import InputError

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
N_BLOCKS = 2
PUBLISHED_DEPTH = 6
DEPTHS = (2, 4, 6, 8)
"""Numbers of layers that the paper says it tried."""
_AGGREGATION = {"a": "add", "m": "max"}


@dataclass(frozen=True)
class Architecture:
    """The layers of a network.

    Attributes
    ----------
    configuration : int
        A row of ``CONFIGURATIONS``.
    dataset : int
        1 or 2: which of the row's aggregations.
    depth : int
        Layers in all, one of ``DEPTHS``. Fewer than the published six are the first of
        them; of more, the others are as the sixth.
    jumping_knowledge : bool
        Whether each of the two blocks ends in attention over its layers, as published,
        or in its last layer.

    Raises
    ------
    InputError
        If there is no such configuration, dataset or depth.
    """

    configuration: int = 3
    dataset: int = 2
    depth: int = PUBLISHED_DEPTH
    jumping_knowledge: bool = True

    def __post_init__(self) -> None:
        if self.configuration not in CONFIGURATIONS:
            raise InputError(f"configuration must be 1…12 (got {self.configuration})")
        if self.dataset not in (1, 2):
            raise InputError(f"dataset must be 1 or 2 (got {self.dataset})")
        if self.depth not in DEPTHS:
            allowed = ", ".join(map(str, DEPTHS))
            raise InputError(f"depth must be one of {allowed} (got {self.depth})")

    def __str__(self) -> str:
        jumping = "with" if self.jumping_knowledge else "without"
        return (
            f"configuration {self.configuration}, dataset {self.dataset}, "
            f"{self.depth} layers, {jumping} jumping knowledge"
        )

    @property
    def layers_a_block(self) -> int:
        """Layers of each of the two blocks."""
        return self.depth // N_BLOCKS

    @property
    def layers(self) -> tuple[tuple[bool, str], ...]:
        """Of every layer: whether it weighs edges, and how it aggregates."""
        types, *aggregations = CONFIGURATIONS[self.configuration]
        letters = aggregations[self.dataset - 1]
        more = self.depth - len(types)
        types, letters = types + types[-1] * more, letters + letters[-1] * more
        return tuple(
            (layer == "G", _AGGREGATION[letter])
            for layer, letter in zip(
                types[: self.depth], letters[: self.depth], strict=True
            )
        )

"""What an ablation tries: one row a panel of its figure."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from physgnn.errors import InputError
from physgnn.learning.physgnn.architecture import (
    DEPTHS,
    N_BLOCKS,
    PUBLISHED_DEPTH,
    Architecture,
)

BEST = {1: 9, 2: 3}  # dataset → configuration with the least published error
# Replaced layers → configuration, of dataset 1 and of dataset 2. Layer types are tried
# with each dataset's best aggregation, of which a row of the first ablation is part.
LAYER_TYPE = {1: (8, 8), 2: (9, 9), 3: (2, 3), 4: (10, 10), 5: (11, 11), 6: (12, 12)}
ALL = "all"


@dataclass(frozen=True)
class Panel:
    """One thing that is changed.

    Attributes
    ----------
    title : str
        What the numbers count.
    architectures : mapping
        Number → the architectures for dataset 1 and for dataset 2.
    """

    title: str
    architectures: Mapping[int, tuple[Architecture, Architecture]]


def _best(
    depth: int = PUBLISHED_DEPTH, *, jumping: bool = True
) -> tuple[Architecture, Architecture]:
    one, two = (Architecture(BEST[n], n, depth, jumping) for n in (1, 2))
    return one, two


PANELS: Mapping[str, Panel] = {
    "aggregation": Panel(
        "Layers that add instead of taking the maximum",
        {k: (Architecture(k + 1, 1), Architecture(k + 1, 2)) for k in range(7)},
    ),
    "layer-type": Panel(
        "Layers that weigh edges (GraphConv)",
        {
            k: (Architecture(a, 1), Architecture(b, 2))
            for k, (a, b) in LAYER_TYPE.items()
        },
    ),
    "depth": Panel("Layers", {depth: _best(depth) for depth in DEPTHS}),
    "jumping-knowledge": Panel(
        "Blocks that end in jumping knowledge",
        {0: _best(jumping=False), N_BLOCKS: _best()},
    ),
}
"""Panel → what it tries; the first two are the paper's tables 3 and 4."""


@dataclass(frozen=True)
class Trial:
    """One network of an ablation.

    Attributes
    ----------
    architecture : Architecture
    seed : int
        Of its first weights and the order of samples.
    """

    architecture: Architecture
    seed: int

    @property
    def name(self) -> str:
        """What it is called in files and progress."""
        of = self.architecture
        more = "" if of.depth == PUBLISHED_DEPTH else f"-depth-{of.depth}"
        more += "" if of.jumping_knowledge else "-without-jumping-knowledge"
        start = f"dataset-{of.dataset}-configuration-{of.configuration}"
        return f"{start}{more}-seed-{self.seed}"

    @property
    def options(self) -> dict[str, Any]:
        """Its options of a training; what is as published is left out."""
        published = Architecture(
            self.architecture.configuration, self.architecture.dataset
        )
        usual, own = asdict(published), asdict(self.architecture)
        always = ("configuration", "dataset")
        return {k: v for k, v in own.items() if k in always or v != usual[k]}


def name_of(key: str) -> str:
    """Return a trial's name; release 0.1 wrote (dataset, configuration, seed)."""
    if not key.startswith("("):
        return key
    dataset, configuration, seed = map(int, key.strip("()").split(","))
    return Trial(Architecture(configuration, dataset), seed).name


def named_panels(names: str) -> dict[str, Panel]:
    """Return panels by their names with commas between, or all.

    Raises
    ------
    InputError
        If there is no such panel.
    """
    if names == ALL:
        return dict(PANELS)
    wanted = [name.strip() for name in names.split(",")]
    for name in wanted:
        if name not in PANELS:
            raise InputError(
                f"panel must be {ALL} or one of {', '.join(PANELS)} (got '{name}')"
            )
    return {name: PANELS[name] for name in wanted}


def trials_of(
    panels: Mapping[str, Panel], datasets: Sequence[int], seeds: int
) -> list[Trial]:
    """Return the networks that panels need, each once; one of each seed first."""
    return [
        Trial(architecture, seed)
        for seed in range(seeds)  # one of each soon makes a whole figure
        for dataset in sorted(datasets)
        for architecture in dict.fromkeys(
            pair[dataset - 1]
            for panel in panels.values()
            for pair in panel.architectures.values()
        )
    ]

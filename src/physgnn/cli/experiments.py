"""The commands that run whole experiments: the demonstration and the published ones."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import stages
from physgnn.cli.console import progress, say, working
from physgnn.errors import InputError

Out = Annotated[Path, typer.Option("--out", "-o", help="Folder for everything.")]


def reproduce(
    out: Out,
    dataset: Annotated[int, typer.Option(help="1 or 2.")] = 2,
    budget_hours: Annotated[
        float, typer.Option(help="Of training, over both splits.")
    ] = 2.5,
    brain: Annotated[
        Path | None, typer.Option(help="Published surface; else the bundled brain.")
    ] = None,
    tumour: Annotated[
        list[Path] | None, typer.Option(help="Surface inside the brain.")
    ] = None,
    clock: Annotated[
        str, typer.Option(help="What counts the hours: wall, or processor.")
    ] = "wall",
) -> None:
    """Repeat the published protocol beside the paper's tables; call to resume."""
    from physgnn.stages.reproduction import Reproduction, reproduce

    tumours = tuple(tumour or ())
    what = Reproduction(dataset, budget_hours, brain, tumours, clock=clock)
    if brain is None:
        say(
            "the bundled brain and its own loads: the published figures are of other "
            "surfaces (give --brain and --tumour)"
        )
    print(reproduce(what, out, show=progress, log=say))


def ablate(
    out: Out,
    dataset_1: Annotated[Path | None, typer.Option(help="Store of paper-1.")] = None,
    dataset_2: Annotated[Path | None, typer.Option(help="Store of paper-2.")] = None,
    epochs: Annotated[int, typer.Option(help="Of each network.")] = 3,
    samples: Annotated[int, typer.Option(help="Training samples an epoch.")] = 400,
    seeds: Annotated[int, typer.Option(help="Networks of each configuration.")] = 3,
    split: Annotated[str, typer.Option(help="path, node or published.")] = "published",
    width: Annotated[
        int, typer.Option(help="Of the networks; 112 as published.")
    ] = 112,
    precision: Annotated[
        str, typer.Option(help="Of training: float32, or bfloat16.")
    ] = "float32",
) -> None:
    """Compare configurations 1 to 12 at a reduced budget; call again to resume."""
    from physgnn.stages.ablation import Ablation, ablate

    given = {1: dataset_1, 2: dataset_2}
    stores = {number: path for number, path in given.items() if path is not None}
    if not stores:
        raise InputError("give --dataset-1, --dataset-2 or both")
    budget = Ablation(epochs, samples, seeds, split, width, precision)
    with progress("ablation") as move:
        print(ablate(stores, budget, out, progress=move))
    print(out / "ablation.png")


def published(
    weights: Annotated[Path, typer.Argument(help="Published state dict, .pt.")],
    golden: Annotated[Path, typer.Option(help="Stored forward pass, .npz.")],
    configuration: Annotated[int, typer.Option(help="1 to 12.")] = 3,
    dataset: Annotated[int, typer.Option(help="1 or 2.")] = 2,
) -> None:
    """Load published weights and compare with a stored forward pass."""
    with working("comparing"):
        difference = stages.published_difference(
            weights, golden, configuration=configuration, dataset=dataset
        )
    print(f"largest difference over all points: {difference:.3g} mm")


def demo(
    folder: Annotated[Path, typer.Argument(help="Where everything goes.")] = Path(
        "demo"
    ),
) -> None:
    """Go from the bundled brain to a report; call again to resume."""
    from physgnn.stages.demo import run_demo

    print(run_demo(folder, show=progress, log=say))


def bundle(
    folder: Annotated[Path, typer.Argument(help="Where the work goes.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Else into the package.")
    ] = None,
) -> None:
    """Make the model that comes with the package; call again to resume."""
    from physgnn.bundled import BUNDLED_RUN
    from physgnn.stages.bundling import bundle

    print(bundle(folder, out or BUNDLED_RUN, show=progress, log=say))

"""The commands that run whole experiments: the demonstration and the published ones."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import NOT_USABLE, progress, say, working
from physgnn.cli.options import OutFolder, PrecisionOption


def reproduce(
    out: OutFolder,
    dataset: Annotated[
        int,
        typer.Option(min=1, max=2, help="Repeat this dataset of the paper, 1 or 2."),
    ] = 2,
    budget_hours: Annotated[
        float, typer.Option(help="Train this long, over both splits.")
    ] = 2.5,
    brain: Annotated[
        Path | None,
        typer.Option(
            help="The published surface of the brain; otherwise the bundled brain is "
            "taken, with its own loads."
        ),
    ] = None,
    tumour: Annotated[
        list[Path] | None,
        typer.Option(help="A surface inside the brain; give it again for another."),
    ] = None,
    clock: Annotated[
        choices.Clock,
        typer.Option(
            help="Count the hours by this clock: processor time is that of all threads "
            "together, which other work on the machine does not shorten."
        ),
    ] = "wall",
) -> None:
    """Repeat the published protocol beside the paper's tables; call it to resume."""
    print(
        stages.reproduce(
            out,
            dataset=dataset,
            budget_hours=budget_hours,
            brain=brain,
            tumour=tumour or (),
            clock=clock,
            show=progress,
            log=say,
        )
    )


def ablate(
    out: OutFolder,
    dataset_1: Annotated[
        Path | None, typer.Option(help="A dataset of preset paper-1 to compare on.")
    ] = None,
    dataset_2: Annotated[
        Path | None, typer.Option(help="A dataset of preset paper-2 to compare on.")
    ] = None,
    epochs: Annotated[
        int, typer.Option(help="Train each network for this many epochs.")
    ] = 3,
    samples: Annotated[
        int, typer.Option(help="Train on this many samples an epoch.")
    ] = 400,
    seeds: Annotated[
        int, typer.Option(help="Train this many networks of each configuration.")
    ] = 3,
    split: Annotated[
        choices.SplitName, typer.Option(help="Hold out samples this way.")
    ] = "published",
    width: Annotated[
        int,
        typer.Option(help="Give the networks this width; the published one is 112."),
    ] = 112,
    precision: PrecisionOption = "float32",
    panel: Annotated[
        str,
        typer.Option(
            help="Change this, or several with commas between, or all: aggregation, "
            "layer-type, depth, jumping-knowledge."
        ),
    ] = "all",
) -> None:
    """Compare the published network with others, small; call it again to resume."""
    with progress("ablation") as move:
        table = stages.ablate(
            out,
            dataset_1=dataset_1,
            dataset_2=dataset_2,
            epochs=epochs,
            samples=samples,
            seeds=seeds,
            split=split,
            width=width,
            precision=precision,
            panel=panel,
            progress=move,
        )
    print(table)
    print(out / "ablation.png")


def _compared() -> list[str]:
    """Return the models that a benchmark compares: finite elements are the truth."""
    return [name for name in choices.names("ModelName") if name != "finite-element"]


def benchmark(
    out: OutFolder,
    task: Annotated[
        choices.TaskName, typer.Option(help="Measure on this task, or on all.")
    ] = "all",
    method: Annotated[
        str,
        typer.Option(
            help="Measure this method, or several with commas between, or all: "
            f"{', '.join(_compared())}, "
            "repaired, rigid, spline, register; or one of your own, as module:Class. "
            "Zero and linear are always measured beside."
        ),
    ] = "all",
    size: Annotated[
        choices.TaskSize,
        typer.Option(
            help="Take the bundled brain with few load paths (tiny), or the task's own "
            "data (full)."
        ),
    ] = "tiny",
    data: Annotated[
        Path | None,
        typer.Option(help="Look into this folder for the data of the full tasks."),
    ] = None,
    minutes: Annotated[
        float | None,
        typer.Option(
            help="Train every network this long, in minutes of processor time; by "
            "default 0.1, or 30 for full tasks."
        ),
    ] = None,
    seed: Annotated[
        int, typer.Option(help="Draw all that is drawn from this seed.")
    ] = 0,
    report: Annotated[
        Path | None,
        typer.Option(
            help="Draw the page and the figure of this folder of results, and measure "
            "nothing."
        ),
    ] = None,
) -> None:
    """Compare every method on the same tasks; call it again to resume.

    The exit code is 3 if a method failed, or one that was named applies to no task.
    """
    outcome = stages.benchmark(
        out,
        task=task,
        method=method,
        size=size,
        data=data,
        minutes=minutes,
        seed=seed,
        report=report,
        show=progress,
        log=say,
    )
    print(outcome)
    if outcome.failed or (method != "all" and outcome.of_no_use):
        raise typer.Exit(NOT_USABLE)


def published(
    weights: Annotated[
        Path, typer.Argument(help="The published weights, a state dict, .pt.")
    ],
    golden: Annotated[
        Path | None,
        typer.Option(
            help="Compare with this stored forward pass of them, .npz; without it only "
            "what the file itself tells is checked."
        ),
    ] = None,
    configuration: Annotated[
        int, typer.Option(help="The weights are of this configuration, 1 to 12.")
    ] = 3,
    dataset: Annotated[
        int, typer.Option(help="The weights are of this dataset, 1 or 2.")
    ] = 2,
    store: Annotated[
        Path | None,
        typer.Option(
            help="Save the network as a run on this dataset, made by simulate: to "
            "evaluate, or to train on with train --from."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="The folder to write that run to."),
    ] = None,
) -> None:
    """Load published weights and compare with a stored forward pass, if given."""
    with working("comparing"):
        difference = stages.published(
            weights,
            golden,
            configuration=configuration,
            dataset=dataset,
            store=store,
            out=out,
        )
    if out is not None:
        print(f"{out}: a run of configuration {configuration} on {store}")
    if difference is not None:
        print(f"largest difference over all points: {difference:.3g} mm")
        return
    print(
        f"{weights}: all weights of a published PhysGNN, read as configuration "
        f"{configuration} of dataset {dataset}; its output on the bundled brain is "
        "finite\n"
        "not checked: whether they are of that configuration and dataset (all twelve "
        "have the same shapes), and whether the output is the published one; both take "
        "--golden"
    )


def demo(
    folder: Annotated[
        Path, typer.Argument(help="The folder to write everything to.")
    ] = Path("demo"),
) -> None:
    """Go from the bundled brain to a report; call it again to resume."""
    print(stages.demo(folder, show=progress, log=say))


def bundle(
    folder: Annotated[Path, typer.Argument(help="The folder to do the work in.")],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            help="The folder to write the model to; by default it goes into the "
            "package.",
        ),
    ] = None,
    family: Annotated[
        bool,
        typer.Option("--family", help="Make the family run that adapt takes, instead."),
    ] = False,
) -> None:
    """Make a model that comes with the package; call it again to resume."""
    print(stages.bundle(folder, out, family=family, show=progress, log=say))


def selftest() -> None:
    """Check this installation in about a minute, and print what was compared."""
    with progress("checking") as move:
        made = stages.selftest(progress=move)
    for check in made:
        verdict = "ok" if check.passed else "WRONG"
        print(
            f"{verdict:6}{check.name:40}{check.found:10.2g} {check.unit} "
            f"(at most {check.limit:.2g})"
        )
    if not all(check.passed for check in made):
        raise typer.Exit(1)

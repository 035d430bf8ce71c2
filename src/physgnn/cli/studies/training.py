"""The command that trains a network."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import progress
from physgnn.cli.options import OutFolder


def train(
    store: Annotated[
        list[Path],
        typer.Argument(
            help="A dataset made by simulate; several, one for each patient."
        ),
    ],
    out: OutFolder,
    config: Annotated[
        Path | None,
        typer.Option(
            help="Take the settings from this TOML file, such as "
            "examples/training.toml; options given here win over it."
        ),
    ] = None,
    model: Annotated[
        str | None,
        typer.Option(
            help="Train this model, lifted by default: one of "
            f"{', '.join(choices.names('ModelName'))}; or one of your own, as "
            "module:Class. What has no steps of training is fitted."
        ),
    ] = None,
    configuration: Annotated[
        int | None,
        typer.Option(
            help="Train the published network, PhysGNN, in this configuration, 1 to 12."
        ),
    ] = None,
    split: Annotated[
        choices.SplitName | None,
        typer.Option(
            help="Hold out samples this way: whole load paths (the default), loaded "
            "nodes, as published, or, of several datasets, whole meshes."
        ),
    ] = None,
    start: Annotated[
        Path | None,
        typer.Option("--from", help="Begin with the weights of this run."),
    ] = None,
    loss: Annotated[
        choices.LossName | None,
        typer.Option(
            help="Make this small in training; by default the published "
            "mean_euclidean, the mean length of the nodal error."
        ),
    ] = None,
    batch_size: Annotated[
        int | None, typer.Option(help="Average the gradient over this many samples.")
    ] = None,
    learning_rate: Annotated[
        float | None,
        typer.Option(help="Begin at this learning rate; the schedule lowers it."),
    ] = None,
    max_epochs: Annotated[
        int | None, typer.Option(help="Stop after this many epochs.")
    ] = None,
    max_minutes: Annotated[
        float | None, typer.Option(help="Stop after this many minutes.")
    ] = None,
    memory_mb: Annotated[
        float | None,
        typer.Option(
            help="Let a training step take this much memory; more may be faster, and "
            "the result is the same."
        ),
    ] = None,
    precision: Annotated[
        choices.PrecisionName | None,
        typer.Option(
            help="Compute the largest products in this precision. Only PhysGNN has "
            "bfloat16: it is rougher, and quicker where the processor multiplies it."
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(help="Draw weights, dropout and the order of samples from this."),
    ] = None,
    device: Annotated[
        choices.Device, typer.Option(help="Train on this kind of processor.")
    ] = choices.Device.CPU,
    devices: Annotated[
        int,
        typer.Option(min=1, help="Share every batch out to this many processes."),
    ] = 1,
    num_nodes: Annotated[
        int,
        typer.Option(
            min=1,
            help="Share every batch out to this many machines, each started by hand or "
            "by a scheduler.",
        ),
    ] = 1,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue an interrupted run.")
    ] = False,
) -> None:
    """Train a network on a dataset and save its best weights."""
    with progress("training") as move:
        checkpoint = stages.train(
            store,
            out,
            config=config,
            model=model,
            configuration=configuration,
            split=split,
            start=start,
            loss=loss,
            batch_size=batch_size,
            learning_rate=learning_rate,
            max_epochs=max_epochs,
            max_minutes=max_minutes,
            memory_mb=memory_mb,
            precision=precision,
            seed=seed,
            device=device,
            devices=devices,
            num_nodes=num_nodes,
            resume=resume,
            progress=move,
        )
    result = checkpoint.record["training"]
    print(
        f"{out}: validation loss {result['best_validation_loss']:.4g} after "
        f"{result['minutes']:.1f} minutes"
    )
    if result["best_epoch"] == 0:
        print(
            f"{out}: no epoch was better than the weights that training began with, "
            "which are kept: give more samples or minutes, or a lower learning rate"
        )

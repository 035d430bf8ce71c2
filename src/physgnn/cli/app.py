"""The commands. Every one has a Python function behind it with the same arguments."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from physgnn import stages
from physgnn.cli import answers, exchange, experiments, images, patients
from physgnn.cli.console import progress, say, working
from physgnn.cli.view import view
from physgnn.errors import InputError

if TYPE_CHECKING:
    from physgnn.geometry import Surface

app = typer.Typer(
    help="Real-time prediction of brain deformation: mesh, finite elements, networks.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

Out = Annotated[Path, typer.Option("--out", "-o", help="Where the result goes.")]
Run = Annotated[Path, typer.Argument(help="Folder of a trained model.")]


def main() -> None:
    """Run the command line; wrong input is one line on standard error and exit 2."""
    if int(os.environ.get("LOCAL_RANK", 0)) > 0:  # the first process speaks for all
        sys.stdout = sys.stderr = open(os.devnull, "w")  # noqa: PTH123, SIM115
    try:
        app()
    except InputError as error:
        say(f"physgnn: {error}")
        sys.exit(2)
    except OSError as error:
        say(f"physgnn: {error.strerror or error}: {error.filename or ''}".rstrip(": "))
        sys.exit(2)


@app.command()
def mesh(
    out: Out,
    segmentation: Annotated[
        Path | None, typer.Argument(help="Label map, NIfTI, instead of surfaces.")
    ] = None,
    labels: Annotated[
        str, typer.Option(help="mask, brats, freesurfer, or such as brain=1,tumour=4.")
    ] = "mask",
    brain_mask: Annotated[
        Path | None, typer.Option(help="NIfTI, not 0 in the brain, for tumour maps.")
    ] = None,
    smoothing_mm: Annotated[
        float | None, typer.Option(help="Of label maps; by default the voxel size.")
    ] = None,
    closing_mm: Annotated[
        float | None, typer.Option(help="Radius that fills sulci of label maps.")
    ] = None,
    brain: Annotated[
        Path | None, typer.Option(help="Surface: STL, PLY, OBJ or VTP, in mm.")
    ] = None,
    tumour: Annotated[
        list[Path] | None, typer.Option(help="Surface inside the brain; repeatable.")
    ] = None,
    mni152: Annotated[
        bool, typer.Option("--mni152", help="Use the bundled brain and tumour.")
    ] = False,
    sets: Annotated[
        Path | None, typer.Option(help="TOML with [point_sets.<name>] tables.")
    ] = None,
    max_volume_mm3: Annotated[
        float | None, typer.Option(help="Largest cell; by default the published rule.")
    ] = None,
    target_points: Annotated[
        int | None, typer.Option(help="About how many points the mesh shall have.")
    ] = None,
    quality_floor: Annotated[
        float | None, typer.Option(help="Smallest mean ratio a cell may have.")
    ] = None,
) -> None:
    """Fill surfaces, or a label map, with tetrahedra and name point sets."""
    from physgnn.config import read_point_sets
    from physgnn.io import write_mesh
    from physgnn.io.atomic import check_folder

    check_folder(out)
    if [mni152, brain is not None, segmentation is not None].count(True) != 1:
        raise InputError("give a label map, --brain, or --mni152 for the bundled case")
    rules = {} if sets is None else read_point_sets(sets)
    common: dict[str, Any] = {
        "rules": rules,
        "quality_floor": quality_floor,
        "log": say,
    }
    with working("meshing"):
        if segmentation is None:
            surface, *inner = _surfaces(brain, tumour or [])
            made = stages.mesh_surfaces(
                surface,
                inner,
                max_volume_mm3=max_volume_mm3,
                target_points=target_points,
                **common,
            )
        else:
            from physgnn.stages.segmentation import mesh_segmentation

            made = mesh_segmentation(
                segmentation,
                labels,
                brain_mask=brain_mask,
                target_points=target_points or 10_000,
                smoothing_mm=smoothing_mm,
                closing_mm=closing_mm,
                **common,
            )
    write_mesh(out, made)
    print(f"{out}: {made.n_points} points, {made.n_cells} cells")


def _surfaces(brain: Path | None, tumours: list[Path]) -> "list[Surface]":
    """Read the surfaces a user names, or take the bundled ones."""
    from physgnn.geometry import mni152_phantom
    from physgnn.io import read_surface

    if brain is not None:
        return [read_surface(path) for path in (brain, *tumours)]
    phantom = mni152_phantom()
    return [phantom.brain, *phantom.tumours]


@app.command()
def simulate(
    case: Annotated[Path, typer.Argument(help="Mesh, VTU.")],
    out: Out,
    preset: Annotated[
        str | None, typer.Option(help="paper-1, paper-2 or demo.")
    ] = None,
    loads: Annotated[
        Path | None, typer.Option(help="TOML with point sets, materials and loads.")
    ] = None,
    workers: Annotated[
        int, typer.Option(min=1, help="Processes on this machine.")
    ] = os.cpu_count() or 1,
    scheduler: Annotated[
        str | None, typer.Option(help="Dask scheduler, tcp://…, instead of workers.")
    ] = None,
    solver: Annotated[str, typer.Option(help="physgnn or febio.")] = "physgnn",
) -> None:
    """Solve load paths by finite elements; call again to resume."""
    from physgnn.config import read_preset
    from physgnn.dataset import verification_of
    from physgnn.io import read_mesh

    if (preset is None) == (loads is None):
        raise InputError("give --preset or --loads")
    chosen: Any = preset if loads is None else read_preset(loads)
    body = read_mesh(case)
    with progress("simulating") as move:
        store, did = stages.simulate(
            body,
            chosen,
            out,
            solver=solver,
            workers=workers,
            scheduler=scheduler,
            source={"mesh": str(case), "command": stages.command_line()},
            progress=move,
        )
    converged = len(store.samples())
    print(
        f"{out}: {did.solved} load paths solved now, {len(store.pending())} pending; "
        f"{converged} of {store.n_paths * store.n_levels} levels converged"
    )
    print(verification_of(store))
    for path, remark in [*store.messages().items()][:20]:
        print(f"load path {path} {remark}")
    for path, error in list(did.errors.items())[:3]:
        say(f"load path {path}: {error}")
    if did.errors:
        raise typer.Exit(1)


@app.command()
def train(
    store: Annotated[
        list[Path], typer.Argument(help="Dataset made by simulate, or several.")
    ],
    out: Out,
    config: Annotated[
        Path | None, typer.Option(help="TOML with training settings.")
    ] = None,
    model: Annotated[
        str | None,
        typer.Option(
            help="physgnn, lifted, reduced, galerkin, pod_network, extra_trees, "
            "nodal_network, linear, zero, …; or module:Class, a method of your own."
        ),
    ] = None,
    configuration: Annotated[
        int | None, typer.Option(help="1 to 12, of the published network.")
    ] = None,
    split: Annotated[
        str | None,
        typer.Option(help="path (default), node or published; mesh of several."),
    ] = None,
    start: Annotated[
        Path | None, typer.Option("--from", help="Run to begin with the weights of.")
    ] = None,
    loss: Annotated[str | None, typer.Option(help="Loss.")] = None,
    batch_size: Annotated[int | None, typer.Option(help="Samples a step.")] = None,
    learning_rate: Annotated[float | None, typer.Option(help="At the start.")] = None,
    max_epochs: Annotated[int | None, typer.Option(help="Stop after so many.")] = None,
    max_minutes: Annotated[
        float | None, typer.Option(help="Stop after so many minutes.")
    ] = None,
    memory_mb: Annotated[
        float | None, typer.Option(help="What a step may take; more may be faster.")
    ] = None,
    precision: Annotated[
        str | None, typer.Option(help="float32, or for PhysGNN bfloat16: quicker.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Of weights and order.")] = None,
    device: Annotated[str, typer.Option(help="cpu, cuda or auto.")] = "cpu",
    devices: Annotated[
        int, typer.Option(min=1, help="Processes that share every batch out.")
    ] = 1,
    num_nodes: Annotated[
        int, typer.Option(min=1, help="Machines, each started by hand or a scheduler.")
    ] = 1,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue an interrupted run.")
    ] = False,
) -> None:
    """Train a network on a dataset; the best weights are kept."""
    from physgnn.config import read_training
    from physgnn.learning.trainer import Machine

    with working("loading"):
        settings = read_training(
            config,
            model=model,
            loss=loss,
            batch_size=batch_size,
            learning_rate=learning_rate,
            max_epochs=max_epochs,
            max_minutes=max_minutes,
            memory_mb=memory_mb,
            precision=precision,
            seed=seed,
            options={} if configuration is None else {"configuration": configuration},
        )
    with progress("training") as move:
        checkpoint = stages.train(
            store,
            split,
            settings,
            out,
            progress=move,
            machine=Machine(device, devices, num_nodes),
            resume=resume,
            start=start,
        )
    result = checkpoint.record["training"]
    print(
        f"{out}: validation loss {result['best_validation_loss']:.4g} after "
        f"{result['minutes']:.1f} minutes"
    )


app.command()(answers.evaluate)
app.command()(answers.predict)
app.command("export")(exchange.export)
app.command("import")(exchange.import_)
app.command()(experiments.demo)
app.command(hidden=True)(experiments.bundle)
app.command()(experiments.published)
app.command()(experiments.reproduce)
app.command()(experiments.ablate)
app.command()(patients.anatomies)
app.command()(patients.adapt)
app.command()(images.warp)
app.command()(images.register)
app.command()(view)

"""The commands to and from other programs."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import progress, working
from physgnn.cli.options import LoadsOption, Materials, PresetOption


def export(
    source: Annotated[
        Path,
        typer.Argument(
            help="A mesh (.vtu) or a dataset for --febio, a dataset for --arrays and "
            "--series, a run for --onnx."
        ),
    ],
    febio: Annotated[
        Path | None,
        typer.Option(
            help="Write one load path as a FEBio 4 model, .feb, to this file."
        ),
    ] = None,
    arrays: Annotated[
        Path | None,
        typer.Option(
            help="Write the whole dataset as NumPy arrays, .npz, to this file."
        ),
    ] = None,
    series: Annotated[
        Path | None,
        typer.Option(
            help="Write the levels of one load path as VTU files to this folder."
        ),
    ] = None,
    onnx: Annotated[
        Path | None, typer.Option(help="Write a run's network, .onnx, to this file.")
    ] = None,
    preset: PresetOption = None,
    loads: LoadsOption = None,
    path: Annotated[
        int, typer.Option(min=0, help="Write this load path, counted from 0.")
    ] = 0,
) -> None:
    """Write a load path for FEBio, or results or a network for other programs."""
    with working("exporting"):
        written = stages.export(
            source,
            febio=febio,
            arrays=arrays,
            series=series,
            onnx=onnx,
            preset=preset,
            loads=loads,
            path=path,
        )
    print(written)


def import_results(
    sources: Annotated[
        list[Path],
        typer.Argument(
            help="FEBio models (.feb, beside their logs), .npz files, or folders of "
            "VTU files."
        ),
    ],
    out: Annotated[Path, typer.Option("--out", "-o", help="The dataset to make.")],
    materials: Materials = None,
    element: Annotated[
        choices.Element,
        typer.Option(help="Take the results for those of this finite element."),
    ] = "tet4",
) -> None:
    """Make a dataset of another solver's results."""
    with progress("importing") as move:
        store = stages.import_results(
            sources, out, materials=materials, element=element, progress=move
        )
    print(
        f"{out}: {store.n_paths} load paths of {store.n_levels} levels, "
        f"{len(store.samples())} levels converged"
    )


def slicer(
    out: Annotated[
        Path, typer.Argument(help="The folder to write the modules to; it is made.")
    ],
) -> None:
    """Write modules for 3D Slicer: segment, mesh, register, warp, predict."""
    made = stages.slicer(out)
    for launcher in made:
        print(launcher)
    print(
        f"add {out.resolve()} to the module paths of 3D Slicer (Edit, Application "
        "Settings, Modules) and restart it"
    )

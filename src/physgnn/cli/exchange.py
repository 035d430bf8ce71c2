"""The commands to and from other programs."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn.cli.console import progress, working
from physgnn.errors import InputError

Sources = Annotated[
    list[Path],
    typer.Argument(
        help="FEBio models (.feb, beside their logs), .npz files, or folders of VTU."
    ),
]


def export(
    source: Annotated[Path, typer.Argument(help="Mesh, VTU, dataset, or run.")],
    febio: Annotated[Path | None, typer.Option(help="FEBio 4 model, .feb.")] = None,
    arrays: Annotated[Path | None, typer.Option(help="NumPy arrays, .npz.")] = None,
    series: Annotated[Path | None, typer.Option(help="Folder of VTU files.")] = None,
    onnx: Annotated[Path | None, typer.Option(help="A run's network, .onnx.")] = None,
    preset: Annotated[
        str | None, typer.Option(help="Loads of a mesh: paper-1, paper-2 or demo.")
    ] = None,
    loads: Annotated[
        Path | None, typer.Option(help="Loads of a mesh: TOML, as for simulate.")
    ] = None,
    path: Annotated[int, typer.Option(min=0, help="Which load path.")] = 0,
) -> None:
    """Write a load path for FEBio, results or a network for other programs."""
    from physgnn.config import read_preset
    from physgnn.dataset.exporting import export_arrays, export_febio, export_series

    if sum(target is not None for target in (febio, arrays, series, onnx)) != 1:
        raise InputError("give one of --febio, --arrays, --series and --onnx")
    with working("exporting"):
        if onnx is not None:
            from physgnn.learning.onnx_export import export_onnx

            export_onnx(source, onnx)
        elif febio is not None:
            chosen = preset if loads is None else read_preset(loads)
            export_febio(source, febio, preset=chosen, path=path)
        elif arrays is not None:
            export_arrays(source, arrays)
        else:
            assert series is not None
            export_series(source, series, path=path)
    print(febio or arrays or series or onnx)


def import_(
    sources: Sources,
    out: Annotated[Path, typer.Option("--out", "-o", help="The dataset.")],
    materials: Annotated[
        Path | None,
        typer.Option(help="TOML with [materials]; FEBio models tell their own."),
    ] = None,
    element: Annotated[
        str, typer.Option(help="The finite element they stand for.")
    ] = "tet4",
) -> None:
    """Make a dataset of another solver's results."""
    from physgnn.config import read_materials
    from physgnn.dataset.importing import import_results

    chosen = read_materials(materials)
    with progress("importing") as move:
        store = import_results(
            sources, out, materials=chosen, element=element, progress=move
        )
    print(
        f"{out}: {store.n_paths} load paths of {store.n_levels} levels, "
        f"{len(store.samples())} levels converged"
    )

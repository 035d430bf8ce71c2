"""The commands that prepare patients: loads to expect, an adapted network, a table."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from physgnn import stages
from physgnn.cli.console import NOT_USABLE, progress, say, working
from physgnn.cli.options import LoadsOption, OutFolder, PresetOption
from physgnn.errors import InputError


def init(
    case: Annotated[Path, typer.Argument(help="The patient's mesh, VTU.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The file to write, TOML.")],
    craniotomy: Annotated[
        Path | None,
        typer.Option(
            help="One point in the middle of the craniotomy: .mrk.json, .fcsv or CSV; "
            "by default the cortex nearest to the tumour."
        ),
    ] = None,
    radius_mm: Annotated[
        float, typer.Option(help="Lay the cortex open over this radius.")
    ] = 30.0,
) -> None:
    """Write what to simulate on a patient, for simulate and adapt --loads."""
    stages.init(case, out, craniotomy=craniotomy, radius_mm=radius_mm, log=say)
    print(f"{out}: run physgnn simulate {case} --loads {out} -o loads.zarr")


def adapt(
    out: OutFolder,
    run: Annotated[
        Path | None,
        typer.Argument(
            help="The folder of a network whose weights serve any body: of "
            "lifted without pod_modes, meshgraphnet, transolver or cnn; by "
            "default, and as bundled-family, the one that comes with the package."
        ),
    ] = None,
    case: Annotated[
        Path | None,
        typer.Argument(metavar="CASE", help="The new patient's mesh, VTU."),
    ] = None,
    preset: PresetOption = None,
    loads: LoadsOption = None,
) -> None:
    """Make a trained network ready for a patient it never saw, in seconds."""
    if case is None:  # the first of two arguments is the one that may be left out
        run, case = None, run
    if case is None:
        raise InputError("name the new patient's mesh, VTU (see physgnn adapt --help)")
    with working("finding equilibria"):
        made = stages.adapt(run, case, out, preset=preset, loads=loads, log=say)
    bound = (
        "no error bounds"
        if made.coverage is None
        else f"error bounds that hold for {100 * made.coverage:.0f} % of new patients"
    )
    for reason in made.unlike:
        say(f"no error bounds, since this body is unlike those trained on: {reason}")
    print(f"{out}: {made.n_points} points, {made.seconds:.1f} s, {bound}")


def batch(
    patients: Annotated[
        Path,
        typer.Argument(
            help="A table, CSV: a row for each patient, a column for its name and for "
            "each option of the stages."
        ),
    ],
    out: OutFolder,
) -> None:
    """Take many patients through mesh, adapt, predict or register, and warp.

    Call it again to resume. The exit code is 3 if a patient failed or is not ok.
    """
    with progress("batch") as move:
        results = stages.batch(patients, out, progress=move, log=say)
    width = max(len(result.name) for result in results)
    for result in results:
        print(f"{result.name:{width}}  {result.said}{_figures(result.figures)}")
    good = sum(result.outcome == "ok" for result in results)
    print(f"{out / 'results.csv'}: {good} of {len(results)} patients ok")
    if good < len(results):
        raise typer.Exit(NOT_USABLE)


def _figures(figures: Mapping[str, Any]) -> str:
    """Return the numbers of a patient in a few words."""
    shown = {
        "points": "{} points",
        "largest_mm": "moves by {} mm",
        "bound_max_mm": "error at most {} mm",
    }
    parts = [
        text.format(figures[name])
        for name, text in shown.items()
        if figures.get(name) is not None
    ]
    return f"; {', '.join(parts)}" if parts else ""

"""The commands that begin or end in images."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn.cli import answers
from physgnn.cli.console import say, working

Out = Annotated[Path, typer.Option("--out", "-o", help="Where the result goes.")]


def warp(
    image: Annotated[Path, typer.Argument(help="Image at rest, NIfTI.")],
    prediction: Annotated[Path, typer.Argument(help="Displacement, VTU.")],
    out: Out,
    labels: Annotated[
        bool, typer.Option("--labels", help="The image is a label map.")
    ] = False,
    interpolation: Annotated[
        str | None, typer.Option(help="linear, nearest or cubic.")
    ] = None,
    field: Annotated[
        list[Path] | None,
        typer.Option(help="Transform for ITK and 3D Slicer, .h5 or .nii.gz."),
    ] = None,
    jacobian: Annotated[
        Path | None, typer.Option(help="Map of the change of volume, NIfTI.")
    ] = None,
    slices: Annotated[
        Path | None, typer.Option(help="Before, after and checkerboard, PNG.")
    ] = None,
) -> None:
    """Deform an image as a prediction says."""
    from physgnn.stages.warping import warp_image

    with working("warping"):
        warp_image(
            image,
            prediction,
            out,
            labels=labels,
            interpolation=interpolation,
            fields=field or [],
            jacobian=jacobian,
            slices=slices,
            log=say,
        )
    print(out)


def register(
    mesh: Annotated[Path, typer.Argument(help="Mesh with the point set fixed, VTU.")],
    out: answers.Out,
    points: Annotated[
        Path | None, typer.Option(help="Measured pairs: CSV, .fcsv or .mrk.json.")
    ] = None,
    target: Annotated[
        Path | None, typer.Option(help="Markups after the shift, if apart.")
    ] = None,
    surface: Annotated[
        Path | None,
        typer.Option(
            help="Instead: the exposed surface after the shift, a mesh (STL, PLY, "
            "OBJ, VTP) or points (CSV, .fcsv, .mrk.json)."
        ),
    ] = None,
    noise_mm: Annotated[
        float, typer.Option(help="Deviation of a measured coordinate.")
    ] = 1.0,
    skull: Annotated[
        str, typer.Option(help="fixed, or sliding: the brain may move along it.")
    ] = "fixed",
    materials: Annotated[
        Path | None, typer.Option(help="TOML with [materials.<region>] tables.")
    ] = None,
    form: answers.Form = None,
    image: answers.Grid = None,
) -> None:
    """Find the whole displacement from what was measured on the surface."""
    from physgnn.config.simulation import read_materials
    from physgnn.stages import registration

    with working("registering"):
        found = registration.register(
            mesh,
            out,
            points=points,
            target=target,
            surface=surface,
            form=form,
            image=image,
            noise_mm=noise_mm,
            skull=skull,
            materials={} if materials is None else read_materials(materials),
        )
    ended = (
        "the displacement can be used with its error estimate"
        if found.prediction.status.usable
        else "the search ended early, since a body held so can hardly move like that: "
        "check points, materials and --skull"
    )
    estimate = found.prediction.error_estimate_mm
    bound = "" if estimate is None else f"error {estimate.mean_mm:.2f} mm on average, "
    most = "" if estimate is None else f"{estimate.max_mm:.2f} mm at most"
    chance = "" if estimate is None else f" ({estimate.coverage:.0%} of cases)"
    print(
        f"{out}: {bound}{most}{chance}, misfit {found.misfit_mm:.2f} mm, of points "
        f"held out {found.held_out_mm:.2f} mm; {found.prediction.seconds:.1f} s; "
        f"{found.prediction.status}: {ended}"
    )

"""The commands that begin or end in images."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import conclude, say, working
from physgnn.cli.options import (
    AffineOption,
    Displacement,
    Form,
    Grid,
    Materials,
    OutFile,
    SeriesOption,
)


def warp(
    image: Annotated[
        Path,
        typer.Argument(
            help="The image at rest: NIfTI, NRRD, MetaImage, FreeSurfer's, or a folder "
            "of DICOM."
        ),
    ],
    prediction: Annotated[
        Path, typer.Argument(help="A displacement written by predict or register, VTU.")
    ],
    out: OutFile,
    labels: Annotated[
        bool, typer.Option("--labels", help="Treat the image as a label map.")
    ] = False,
    interpolation: Annotated[
        choices.Interpolation | None,
        typer.Option(
            help="Interpolate between voxels this way; by default linearly, and the "
            "nearest of a label map."
        ),
    ] = None,
    field: Annotated[
        list[Path] | None,
        typer.Option(
            help="Write the transform for ITK and 3D Slicer too, to this .h5 or "
            ".nii.gz file; give it again for another."
        ),
    ] = None,
    jacobian: Annotated[
        Path | None,
        typer.Option(help="Write a map of the change of volume to this image."),
    ] = None,
    slices: Annotated[
        Path | None,
        typer.Option(
            help="Draw slices before, after and as a checkerboard to this PNG file."
        ),
    ] = None,
    affine: AffineOption = None,
    series: SeriesOption = None,
) -> None:
    """Deform an image as a prediction says."""
    from physgnn.io.medical.images.formats import named_like

    with working("warping"):
        stages.warp(
            image,
            prediction,
            out,
            labels=labels,
            interpolation=interpolation,
            field=field or (),
            jacobian=jacobian,
            slices=slices,
            affine=affine,
            series=series,
            log=say,
        )
    print(named_like(out, image))


def register(
    mesh: Annotated[
        Path, typer.Argument(help="The mesh, with its point set 'fixed', VTU.")
    ],
    out: Displacement,
    points: Annotated[
        Path | None,
        typer.Option(
            help="Pairs of points measured before and after: CSV, .tag, .fcsv or "
            ".mrk.json."
        ),
    ] = None,
    target: Annotated[
        Path | None,
        typer.Option(
            help="The points after the shift, where they are markups of their own."
        ),
    ] = None,
    surface: Annotated[
        Path | None,
        typer.Option(
            help="The exposed surface after the shift, instead of points: a mesh (STL, "
            "PLY, OBJ, VTP, VTK, OFF …) or points (CSV, .tag, .fcsv, .mrk.json)."
        ),
    ] = None,
    noise_mm: Annotated[
        float,
        typer.Option(
            help="Trust every measured coordinate to this standard deviation."
        ),
    ] = 1.0,
    skull: Annotated[
        choices.Skull,
        typer.Option(
            help="Hold the fixed points fast, or let them slide along the skull."
        ),
    ] = "fixed",
    materials: Materials = None,
    form: Form = None,
    image: Grid = None,
    affine: AffineOption = None,
) -> None:
    """Find the whole displacement from what was measured on the surface.

    The exit code is 3 if the displacement that is written is not ok.
    """
    with working("registering"):
        found = stages.register(
            mesh,
            out,
            points=points,
            target=target,
            surface=surface,
            noise_mm=noise_mm,
            skull=skull,
            materials=materials,
            form=form,
            image=image,
            affine=affine,
            log=say,
        )
    status = found.prediction.status
    estimate = found.prediction.error_estimate_mm
    bound = "" if estimate is None else f"error {estimate.mean_mm:.2f} mm on average, "
    most = "" if estimate is None else f"{estimate.max_mm:.2f} mm at most"
    chance = "" if estimate is None else f" ({estimate.coverage:.0%} of cases)"
    print(
        f"{out}: {bound}{most}{chance}, misfit {found.misfit_mm:.2f} mm, of points "
        f"held out {found.held_out_mm:.2f} mm; {found.prediction.seconds:.1f} s; "
        f"{status}: {status.remedy}"
    )
    conclude(status, found.prediction.reasons)

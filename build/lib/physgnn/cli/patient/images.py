"""The command that ends in images."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import conclude_stored, say, working
from physgnn.cli.options import AffineOption, OutFile, SeriesOption


def warp(
    image: Annotated[
        Path,
        typer.Argument(
            help="The image at rest: NIfTI, NRRD, MetaImage, FreeSurfer's, or a folder "
            "of DICOM. Or what was planned on it, points, curves, a model or tracts: "
            f"{', '.join(choices.names('PlanSuffix'))}."
        ),
    ],
    prediction: Annotated[
        Path, typer.Argument(help="A displacement written by predict or register, VTU.")
    ],
    out: OutFile,
    back: Annotated[
        bool,
        typer.Option(
            "--back",
            help="Take what is of the deformed state, such as a postoperative scan, "
            "back to the rest state.",
        ),
    ] = False,
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
    """Deform an image, or what was planned on it, as a prediction says.

    The exit code is 3 if the displacement is not ok.
    """
    from physgnn.stages.patient.images.warping import result_name

    with working("warping"):
        stages.warp(
            image,
            prediction,
            out,
            back=back,
            labels=labels,
            interpolation=interpolation,
            field=field or (),
            jacobian=jacobian,
            slices=slices,
            affine=affine,
            series=series,
            log=say,
        )
    print(result_name(out, image))
    conclude_stored(prediction)

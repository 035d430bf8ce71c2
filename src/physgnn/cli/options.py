"""Options and arguments that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices

OutFile = Annotated[
    Path, typer.Option("--out", "-o", help="The file to write the result to.")
]
OutFolder = Annotated[
    Path, typer.Option("--out", "-o", help="The folder to write the results to.")
]
Run = Annotated[Path, typer.Argument(help="The folder of a trained model.")]
PresetOption = Annotated[
    choices.PresetName | None,
    typer.Option(
        help="Take fixed points, materials and loads from this published or bundled "
        "set-up."
    ),
]
LoadsOption = Annotated[
    Path | None,
    typer.Option(
        help="Take point sets, materials and loads from this TOML file, such as "
        "examples/craniotomy.toml."
    ),
]
Materials = Annotated[
    Path | None,
    typer.Option(
        help="Take the materials from the [materials.<region>] tables of this TOML "
        "file; otherwise the published ones are used."
    ),
]
PrecisionOption = Annotated[
    choices.PrecisionName,
    typer.Option(
        help="Compute the largest products in this precision. Only PhysGNN has "
        "bfloat16: it is rougher, and quicker where the processor multiplies it."
    ),
]
AffineOption = Annotated[
    choices.AffineForm | None,
    typer.Option(
        "--affine",
        help="Place a NIfTI image by this part of its header, where sform and qform "
        "disagree by more than a voxel.",
    ),
]
SeriesOption = Annotated[
    str | None,
    typer.Option(
        "--series",
        help="Take the series of this UID from a folder of DICOM that holds several.",
    ),
]
Displacement = Annotated[
    Path,
    typer.Option(
        "--out",
        "-o",
        help="The file to write: .vtu (the mesh at rest with the displacement), .vtp "
        "(deformed surfaces), .h5 (a transform for ITK and 3D Slicer) or .nii.gz (a "
        "displacement field).",
    ),
]
Form = Annotated[
    str | None,
    typer.Option(
        "--as",
        help="What to write where the suffix leaves a choice: rest or deformed for "
        ".vtu; field, itk-field or labels for .nii.gz. The others, deformed for .vtp "
        "and transform for .h5, need not be named.",
    ),
]
Grid = Annotated[
    Path | None,
    typer.Option(
        "--image",
        help="Write a field or a label map on the voxels of this image.",
    ),
]
AnySizeOption = Annotated[
    bool,
    typer.Option(
        "--any-size",
        help="Accept a brain of less than 50 or more than 2500 ml, such as a phantom.",
    ),
]

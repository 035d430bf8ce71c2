"""The command from surfaces, or a label map, to a mesh."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import say, working
from physgnn.cli.options import AffineOption, AnySizeOption, OutFile, SeriesOption


def mesh(
    out: OutFile,
    segmentation: Annotated[
        Path | None,
        typer.Argument(
            help="A label map to mesh instead of surfaces (NIfTI, NRRD, MetaImage, "
            "FreeSurfer's), or a mesh of tetrahedra of another program (.msh, .inp, "
            ".vtk, .vtu, .mesh)."
        ),
    ] = None,
    labels: Annotated[
        str,
        typer.Option(
            help="Which label is which tissue: the name of a convention (mask; "
            "segment; freesurfer, synthseg, neuromorphometrics, harvard-oxford, or "
            "atlas where all is brain; brats, or exactly one of brats-2013, "
            "brats-2020, brats-2023, brats-post, brats-ped, brats-men-rt and msd), a "
            "list such as brain=1,tumour=4, or a name and what differs, "
            "freesurfer,tumour=99. Names of segments, or of groups of cells, may stand "
            "for numbers."
        ),
    ] = "mask",
    brain_mask: Annotated[
        Path | None,
        typer.Option(
            help="An image that is not 0 inside the brain, for label maps that "
            "mark the tumour alone."
        ),
    ] = None,
    ventricles: Annotated[
        Path | None,
        typer.Option(
            help="A T1 with the voxels of the label map, in which ventricles are "
            "found, for label maps that have none."
        ),
    ] = None,
    smoothing_mm: Annotated[
        float | None,
        typer.Option(
            help="Smooth the surface of a label map over this length; by default over "
            "the size of a voxel."
        ),
    ] = None,
    closing_mm: Annotated[
        float | None,
        typer.Option(help="Fill the sulci of a label map by a closing of this radius."),
    ] = None,
    smallest_mm3: Annotated[
        float,
        typer.Option(
            help="Take pieces of tumour or ventricle below this volume for brain."
        ),
    ] = 200.0,
    brain: Annotated[
        Path | None,
        typer.Option(
            help="The surface of the brain, in mm: "
            f"{', '.join(choices.names('SurfaceSuffix'))}."
        ),
    ] = None,
    tumour: Annotated[
        list[Path] | None,
        typer.Option(help="A surface inside the brain; give it again for another."),
    ] = None,
    mni152: Annotated[
        bool, typer.Option("--mni152", help="Mesh the bundled brain and tumour.")
    ] = False,
    sets: Annotated[
        Path | None,
        typer.Option(
            help="Name the point sets of the [point_sets.<name>] tables of this TOML "
            "file."
        ),
    ] = None,
    max_volume_mm3: Annotated[
        float | None,
        typer.Option(
            help="Let no cell be larger than this; by default the published rule "
            "decides."
        ),
    ] = None,
    target_points: Annotated[
        int | None,
        typer.Option(help="Aim at about this many points, instead of a cell size."),
    ] = None,
    keep_surface: Annotated[
        bool,
        typer.Option(
            "--keep-surface",
            help="Keep the points of surfaces, as published, instead of remeshing "
            "what is finer than --target-points needs.",
        ),
    ] = False,
    mesher: Annotated[
        choices.Mesher | None,
        typer.Option(
            help="Fill the surfaces by this program; by default by tetwild, but by "
            "tetgen, if it is installed, where the surfaces' points are kept."
        ),
    ] = None,
    quality_floor: Annotated[
        float | None,
        typer.Option(help="Refuse a mesh with a cell whose mean ratio is below this."),
    ] = None,
    ignore_labels: Annotated[
        bool,
        typer.Option(
            "--ignore-labels",
            help="Leave labels that are not named out of the mesh, however large their "
            "volume is.",
        ),
    ] = False,
    any_size: AnySizeOption = False,
    affine: AffineOption = None,
    series: SeriesOption = None,
) -> None:
    """Fill surfaces, or a label map, with tetrahedra and name point sets."""
    with working("meshing"):
        made = stages.mesh(
            out,
            segmentation=segmentation,
            labels=labels,
            brain_mask=brain_mask,
            ventricles=ventricles,
            smoothing_mm=smoothing_mm,
            closing_mm=closing_mm,
            smallest_mm3=smallest_mm3,
            brain=brain,
            tumour=tumour or (),
            mni152=mni152,
            sets=sets,
            max_volume_mm3=max_volume_mm3,
            target_points=target_points,
            keep_surface=keep_surface,
            mesher=mesher,
            quality_floor=quality_floor,
            ignore_labels=ignore_labels,
            any_size=any_size,
            affine=affine,
            series=series,
            log=say,
        )
    print(f"{out}: {made.n_points} points, {made.n_cells} cells")

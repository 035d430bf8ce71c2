"""The command that begins with what was measured in the operating theatre."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from physgnn import choices, stages
from physgnn.cli.console import NOT_USABLE, conclude, say, working
from physgnn.cli.options import AffineOption, Displacement, Form, Grid, Materials

if TYPE_CHECKING:  # torch takes seconds to import
    from physgnn.registration.result import Registration
    from physgnn.stages.patient.intraoperative.state_series import StateResult

Noise = Annotated[
    float | None, typer.Option(help="Of these; by default that of --noise-mm.")
]

MOST_NAMES = 5  # of pairs that were left out, in one line


def register(
    mesh: Annotated[
        Path, typer.Argument(help="The mesh, with its point set 'fixed', VTU.")
    ],
    out: Displacement,
    points: Annotated[
        Path | None,
        typer.Option(
            help="Pairs of points of the surface before and after: "
            f"{', '.join(choices.names('PointSuffix'))}."
        ),
    ] = None,
    target: Annotated[
        Path | None,
        typer.Option(
            help="The points after the shift, where they are markups of their own."
        ),
    ] = None,
    landmarks: Annotated[
        Path | None,
        typer.Option(help="Pairs of points inside the brain, in the same formats."),
    ] = None,
    landmarks_target: Annotated[
        Path | None,
        typer.Option(
            help="The landmarks after the shift, where they are markups of their own."
        ),
    ] = None,
    surface: Annotated[
        Path | None,
        typer.Option(
            help="The exposed surface after the shift: a mesh "
            f"({', '.join(choices.names('SurfaceSuffix'))}) or points "
            f"({', '.join(choices.names('PointSuffix'))})."
        ),
    ] = None,
    whole_surface: Annotated[
        Path | None,
        typer.Option(help="The whole surface of the brain after the shift, a mesh."),
    ] = None,
    intraoperative: Annotated[
        Path | None,
        typer.Option(
            help="An MR scan of the head after the shift, whose brain is segmented and "
            "taken as the whole surface; or a label map of it."
        ),
    ] = None,
    bone: Annotated[
        Path | None,
        typer.Option(
            help="Pairs of points of the bone, or of what is fixed to it, where the "
            "scan has them and where the navigation finds them now: its offset is then "
            "known and corrected. The same formats; --transformed says which ends "
            "--initial-transform is for."
        ),
    ] = None,
    bone_target: Annotated[
        Path | None,
        typer.Option(
            help="The bone points as they are found now, where they are markups of "
            "their own."
        ),
    ] = None,
    series: Annotated[
        Path | None,
        typer.Option(
            help="Register the states of this table, CSV, one after the other: columns "
            "name or time, and points, target, landmarks, landmarks_target, surface, "
            "whole_surface, intraoperative, bone, bone_target or initial_transform. "
            "The result is a folder."
        ),
    ] = None,
    initial_transform: Annotated[
        Path | None,
        typer.Option(
            help="From the space of the measurement to the scan's: 4 x 4 as text "
            "(RAS), or .tfm or .h5 as 3D Slicer saves it."
        ),
    ] = None,
    transformed: Annotated[
        choices.Transformed,
        typer.Option(
            help="Transform both ends of pairs, or those after the shift alone."
        ),
    ] = "both",
    noise_mm: Annotated[
        float,
        typer.Option(
            help="Trust every measured coordinate to this standard deviation."
        ),
    ] = 1.0,
    landmark_noise_mm: Noise = None,
    surface_noise_mm: Noise = None,
    whole_surface_noise_mm: Annotated[
        float | None,
        typer.Option(
            help="Of this; by default that of --noise-mm, and of a scan 2 mm at least."
        ),
    ] = None,
    bone_noise_mm: Noise = None,
    rigid_offset: Annotated[
        bool,
        typer.Option(
            "--rigid-offset",
            help="Correct a rigid offset of the navigation that the brain alone tells "
            "of; --bone needs no such option.",
        ),
    ] = False,
    backend: Annotated[
        choices.BrainBackend,
        typer.Option(help="Find the brain in an intraoperative scan by this program."),
    ] = "auto",
    contrast: Annotated[
        choices.Contrast,
        typer.Option(help="Say which contrast the intraoperative scan has."),
    ] = "t1",
    any_size: Annotated[
        bool,
        typer.Option(
            "--any-size",
            help="Accept a brain of less than 50 or more than 2500 ml in it, such as a "
            "phantom.",
        ),
    ] = False,
    picture: Annotated[
        Path | None,
        typer.Option(
            help="Draw the outline of the intraoperative brain to this PNG file "
            "instead of one beside the result."
        ),
    ] = None,
    skull: Annotated[
        choices.Skull,
        typer.Option(
            help="Hold the fixed points fast, or let them slide along the skull."
        ),
    ] = "fixed",
    remove: Annotated[
        str | None,
        typer.Option(
            help="Take this region, such as tumour, out before: it was resected."
        ),
    ] = None,
    causes: Annotated[
        str | None,
        typer.Option(
            help="Expect these causes of the shift, with commas between them: gravity, "
            "near-swelling, brain-swelling, collapse; or none. By default all that the "
            "mesh has the regions for."
        ),
    ] = None,
    membranes: Annotated[
        Path | None,
        typer.Option(
            help="Hold falx and tentorium as the [membranes] table of this TOML file "
            "says; otherwise they are left out."
        ),
    ] = None,
    materials: Materials = None,
    form: Form = None,
    image: Grid = None,
    affine: AffineOption = None,
    misfits: Annotated[
        Path | None,
        typer.Option(
            help="Write how far each measured place is off, and its weight, to this "
            "CSV file."
        ),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(
            help="Write a page about it into this folder, report.html: before and "
            "after, of the image of --image where one is given; uncertainty; misfit by "
            "point."
        ),
    ] = None,
) -> None:
    """Find the whole displacement from everything that was measured.

    The exit code is 3 if the displacement that is written is not ok, or a state of a
    series failed. Call a series again to resume it.
    """
    with working("registering"):
        found: Any = stages.register(
            mesh,
            out,
            points=points,
            target=target,
            landmarks=landmarks,
            landmarks_target=landmarks_target,
            surface=surface,
            whole_surface=whole_surface,
            intraoperative=intraoperative,
            bone=bone,
            bone_target=bone_target,
            series=series,
            initial_transform=initial_transform,
            transformed=transformed,
            noise_mm=noise_mm,
            landmark_noise_mm=landmark_noise_mm,
            surface_noise_mm=surface_noise_mm,
            whole_surface_noise_mm=whole_surface_noise_mm,
            bone_noise_mm=bone_noise_mm,
            rigid_offset=rigid_offset,
            backend=backend,
            contrast=contrast,
            any_size=any_size,
            picture=picture,
            skull=skull,
            remove=remove,
            causes=causes,
            membranes=membranes,
            materials=materials,
            form=form,
            image=image,
            affine=affine,
            misfits=misfits,
            report=report,
            log=say,
        )
    if series is not None:
        _conclude_series(out, found)
        return
    print(f"{out}: {_summary(found)}")
    conclude(found.prediction.status, found.prediction.reasons)


def _conclude_series(out: Path, states: "Sequence[StateResult]") -> None:
    """Print how each state fared; exit code 3 if one is not ok."""
    for state in states:
        moved = state.figures.get("largest_mm")
        shown = "" if moved is None else f"; moves by {moved} mm"
        print(f"{state.name}  {state.said}{shown}")
    good = sum(state.outcome == "ok" for state in states)
    print(f"{out / 'series.pvd'}: {good} of {len(states)} states ok")
    if good < len(states):
        raise typer.Exit(NOT_USABLE)


def _summary(found: "Registration") -> str:
    """Return what a registration found, in one line."""
    status, bound = found.prediction.status, found.prediction.error_estimate_mm
    outliers = len(found.outliers)
    error = (
        ""
        if bound is None
        else f"error {bound.mean_mm:.2f} mm on average, {bound.max_mm:.2f} mm at most "
        f"({bound.coverage:.0%} of cases), "
    )
    left = f", {outliers} of {len(found.misfits)} outliers" if outliers else ""
    return (
        f"{error}misfit {found.misfit_mm:.2f} mm, of points held out "
        f"{found.held_out_mm:.2f} mm{left}; {found.navigation}; "
        f"{found.prediction.seconds:.1f} s; {status}{_without(found.left_out)}: "
        f"{status.remedy_for('register')}"
    )


def _without(left_out: "Sequence[str]") -> str:
    """Return which pairs a status is without."""
    if not left_out:
        return ""
    more = len(left_out) - MOST_NAMES
    named = ", ".join(left_out[:MOST_NAMES])
    return f" without {named}" + (f" and {more} more" if more > 0 else "")

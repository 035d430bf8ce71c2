"""The command that fits a material."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import working


def fit_material(
    curves: Annotated[
        Path,
        typer.Argument(
            help="The measured curves, text in columns. With a header: tension_stretch "
            "and tension_stress_kpa, compression_stretch and compression_stress_kpa, "
            "shear_amount and shear_stress_kpa, one pair or more; _pa for _kpa where "
            "the stress is in Pa. Without a header: these six in this order. Stretch "
            "is 1 at rest; stress is force over area at rest, negative in compression."
        ),
    ],
    law: Annotated[
        choices.FittedLaw, typer.Option(help="Fit this law of elasticity.")
    ] = "ogden",
    terms: Annotated[
        int, typer.Option(min=1, max=2, help="Give Ogden's law one term or two.")
    ] = 1,
    unit: Annotated[
        choices.StressUnit | None,
        typer.Option(
            help="Read stresses in this unit where their column names none; otherwise "
            "in kPa."
        ),
    ] = None,
    poissons_ratio: Annotated[
        float | None,
        typer.Option(
            help="Take this Poisson's ratio of the rest state, which the curves do not "
            "determine; otherwise it is 0.49."
        ),
    ] = None,
    bulk_modulus_pa: Annotated[
        float | None,
        typer.Option(help="Take this bulk modulus, Pa, instead of Poisson's ratio."),
    ] = None,
    region: Annotated[
        str,
        typer.Option(
            help="Name the table for brain, tumour, ventricle or a region's number."
        ),
    ] = "brain",
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            help="Write the table to this file too, .toml; it is printed.",
        ),
    ] = None,
    chart: Annotated[
        Path | None,
        typer.Option(
            help="Draw stress over stretch with the fitted curves to this file, .png."
        ),
    ] = None,
) -> None:
    """Fit a material to measured tension, compression and shear."""
    with working("fitting"):
        fitted = stages.fit_material(
            curves,
            law=law,
            terms=terms,
            unit=unit,
            poissons_ratio=poissons_ratio,
            bulk_modulus_pa=bulk_modulus_pa,
            region=region,
            out=out,
            chart=chart,
        )
    print(fitted.table, end="")

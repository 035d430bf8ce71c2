"""From measured stress to a material that `simulate` takes."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from physgnn.config.materials import material_table
from physgnn.errors import InputError
from physgnn.evaluation.report.plots.stress_chart import draw_stress, errors_in_words
from physgnn.io.integrity.atomic import write_whole
from physgnn.io.stress_curves import read_stress_curves
from physgnn.mechanics.materials import Material
from physgnn.mechanics.materials.fitted_laws import (
    BulkModulus,
    bulk_modulus_by_ratio,
    constant_bulk_modulus,
)
from physgnn.mechanics.materials.fitting import fit_law
from physgnn.stages.outputs import Output, writes

POISSONS_RATIO = 0.49  # of brain and tumour as published: Salehi & Giannacopoulos 2022


@dataclass(frozen=True)
class FittedMaterial:
    """A material, and how well it follows the curves.

    Attributes
    ----------
    material : Material
    errors : mapping of str to float
        Kind of curve → RMS error over RMS stress.
    notes : tuple of str
        What the curves do not determine.
    table : str
        TOML: the errors and notes as comments, and the table ``[materials.<region>]``.
    """

    material: Material
    errors: Mapping[str, float]
    notes: tuple[str, ...]
    table: str


@writes(out=Output((".toml",)), chart=Output((".png",)))
def fit_material(
    curves: str | Path,
    *,
    law: str = "ogden",
    terms: int = 1,
    unit: str | None = None,
    poissons_ratio: float | None = None,
    bulk_modulus_pa: float | None = None,
    region: str = "brain",
    out: str | Path | None = None,
    chart: str | Path | None = None,
) -> FittedMaterial:
    """Fit a law to measured tension, compression and shear, all together.

    Parameters
    ----------
    curves : path
        CSV, or six columns without a header: see `physgnn.io.stress_curves`.
    law : str
        ``"neo-hookean"``, ``"mooney-rivlin"`` or ``"ogden"``.
    terms : int
        How many terms Ogden's law has, 1 or 2.
    unit : str, optional
        Of stresses whose column does not tell: ``"kpa"``, by default, or ``"pa"``.
    poissons_ratio : float, optional
        ν of the rest state, which the curves do not determine; 0.49 by default.
    bulk_modulus_pa : float, optional
        κ of the rest state, Pa, in the place of ν.
    region : str
        Whose material it shall be: brain, tumour, ventricle or a region's number.
    out : path, optional
        File to write the table to, .toml.
    chart : path, optional
        Picture of stress over stretch with the fitted curves, .png.

    Returns
    -------
    FittedMaterial
        The material, and how well it follows each curve.

    Raises
    ------
    InputError
        If the curves or an option cannot be used. No file is written then.
    """
    bulk = _bulk_modulus(poissons_ratio, bulk_modulus_pa)
    measured = read_stress_curves(curves, unit=unit)
    fit = fit_law(measured, law, bulk=bulk, terms=terms)
    table = material_table(fit.material, region)
    comments = [
        f"{law}, fitted to {Path(curves).name}",
        f"RMS error over RMS stress: {errors_in_words(fit.errors)}",
        *fit.notes,
    ]
    table = "".join(f"# {line}\n" for line in comments) + table
    if chart is not None:
        name = f"{law}: {errors_in_words(fit.errors)}"
        draw_stress(measured, {name: fit.material}, Path(chart))
    if out is not None:
        write_whole(Path(out), table)
    return FittedMaterial(fit.material, fit.errors, fit.notes, table)


def _bulk_modulus(
    poissons_ratio: float | None, bulk_modulus_pa: float | None
) -> BulkModulus:
    if bulk_modulus_pa is None:
        ratio = POISSONS_RATIO if poissons_ratio is None else poissons_ratio
        return bulk_modulus_by_ratio(ratio)
    if poissons_ratio is not None:
        raise InputError("give --poissons-ratio or --bulk-modulus-pa, not both")
    return constant_bulk_modulus(bulk_modulus_pa)

"""Materials in TOML: a tissue by name, or a law and its parameters.

::

    [materials.brain]             # or tumour, ventricle, or a region's number
    tissue = "brain-ogden"

    [materials.tumour]            # a row of LAWS; "neo-hookean" if left out
    law = "mooney-rivlin"
    c1_pa = 1000
    c2_pa = 250
    bulk_modulus_pa = 120_000
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Tag

from physgnn.config.tables import TAG, ConfigTable, read_as, read_toml, variants
from physgnn.dataset.presets import BRAIN_AND_TUMOUR
from physgnn.errors import InputError
from physgnn.mechanics.materials import TISSUES, Material, NeoHookean
from physgnn.mechanics.materials.table import LAWS, material_to_config

REGIONS = {"brain": 0, "tumour": 1, "ventricle": 2}


def region_of(name: str | int) -> int:
    """Return the number of a region; InputError if it is neither number nor name."""
    if str(name) not in REGIONS and not str(name).isdecimal():
        raise InputError(
            f"unknown region '{name}' (use {', '.join(REGIONS)} or the region's number)"
        )
    return REGIONS[str(name)] if str(name) in REGIONS else int(name)


def _by_region(materials: Mapping[str, Material]) -> dict[int, Material]:
    return {region_of(name): material for name, material in materials.items()}


class ByTissue(ConfigTable):
    """A material by the name of a tissue, and nothing beside it."""

    tissue: Literal[tuple(TISSUES)]  # type: ignore[valid-type]


def _of_tissue(table: ByTissue) -> Material:
    return TISSUES[table.tissue].material


def _kind(table: Any) -> str:
    has_tissue = isinstance(table, Mapping) and "tissue" in table
    return f"{TAG}tissue" if has_tissue else f"{TAG}law"


MATERIAL: Any = Annotated[
    Annotated[ByTissue, AfterValidator(_of_tissue), Tag(f"{TAG}tissue")]
    | Annotated[variants("law", LAWS, default=NeoHookean.law), Tag(f"{TAG}law")],
    Discriminator(_kind),
]
MATERIALS: Any = Annotated[dict[str, MATERIAL], AfterValidator(_by_region)]
"""The table ``[materials]``."""


def material_table(material: Material, region: str) -> str:
    """Return the table of a region's material as TOML; `read_materials` reads it.

    Raises
    ------
    InputError
        If there is no such region.
    """
    region_of(region)
    lines = [f"[materials.{region}]"]
    for name, value in material_to_config(material).items():
        is_text = isinstance(value, str)
        shown = list(value) if isinstance(value, tuple) else value
        lines.append(f'{name} = "{shown}"' if is_text else f"{name} = {shown!r}")
    return "\n".join(lines) + "\n"


def read_materials(path: str | Path | None) -> dict[int, Material]:
    """Read only the materials of a TOML file, by region; other tables may be there.

    Regions it does not name, or all if there is no file, have the published materials.

    Parameters
    ----------
    path : path or None
        The TOML file.

    Returns
    -------
    dict of int to Material
        By region: 0 brain, 1 tumour, 2 ventricle.

    Raises
    ------
    InputError
        If the file cannot be read, has no [materials], or one is wrong.
    """
    if path is None:
        return dict(BRAIN_AND_TUMOUR)
    file = read_toml(path)
    if "materials" not in file:
        raise InputError(
            f"{path}: expected a table [materials] (got {', '.join(file)})"
        )
    named = read_as(MATERIALS, file["materials"], path, at=("materials",))
    return {**BRAIN_AND_TUMOUR, **named}

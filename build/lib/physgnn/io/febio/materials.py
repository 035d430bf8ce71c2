"""Materials as FEBio writes them: names of laws and parameters, in MPa.

Our laws are FEBio's (see `physgnn.mechanics.materials`), so only names and units
change. Units change by moving the decimal point of the printed number, which loses
nothing.
"""

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from typing import Any

from physgnn.errors import InputError
from physgnn.io.febio.elements import moved_point
from physgnn.mechanics.materials import Material, material_from_config
from physgnn.mechanics.materials.table import material_to_config

PA_PER_MPA_DIGITS = 6

# Our law → FEBio's type, and our parameter → FEBio's tag; a tuple's tags are numbered.
NAMES: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "neo-hookean": ("neo-Hookean", {"youngs_modulus_pa": "E", "poissons_ratio": "v"}),
    "mooney-rivlin": (
        "Mooney-Rivlin",
        {"c1_pa": "c1", "c2_pa": "c2", "bulk_modulus_pa": "k"},
    ),
    "ogden": (
        "Ogden",
        {"coefficients_pa": "c", "exponents": "m", "bulk_modulus_pa": "k"},
    ),
}


def febio_material(material: Material) -> tuple[str, dict[str, str]]:
    """Return FEBio's type of a material, and tag → number as printed.

    Raises
    ------
    InputError
        If FEBio has no such law.
    """
    if material.law not in NAMES:
        raise InputError(
            f"FEBio has no material like '{material.law}' (it has: {', '.join(NAMES)})"
        )
    name, tags = NAMES[material.law]
    values = material_to_config(material)
    printed = {}
    for key, tag in tags.items():
        for numbered, value in _numbered(tag, values[key]):
            printed[numbered] = _shifted(key, repr(float(value)), -PA_PER_MPA_DIGITS)
    return name, printed


def material_of(element: ET.Element) -> Material:
    """Return the material of a ``<material>`` element.

    Raises
    ------
    InputError
        If its type is not one of ours, or a parameter is missing or not a number.
    """
    name = element.get("type", "")
    laws = {febio: (law, tags) for law, (febio, tags) in NAMES.items()}
    if name not in laws:
        raise InputError(f"material type '{name}' is not one of {', '.join(laws)}")
    law, tags = laws[name]
    config: dict[str, Any] = {"law": law}
    for key, tag in tags.items():
        if key in ("coefficients_pa", "exponents"):
            config[key] = tuple(_terms(element, key, tag))
        else:
            config[key] = _number(element, key, tag)
    return material_from_config(config)


def _numbered(tag: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, tuple | list):
        yield from ((f"{tag}{i}", term) for i, term in enumerate(value, 1))
    else:
        yield tag, value


def _terms(element: ET.Element, key: str, tag: str) -> Iterator[float]:
    i = 1
    while element.find(f"{tag}{i}") is not None:
        yield _number(element, key, f"{tag}{i}")
        i += 1


def _number(element: ET.Element, key: str, tag: str) -> float:
    text = (element.findtext(tag) or "").strip()
    try:
        return float(_shifted(key, text, PA_PER_MPA_DIGITS))
    except ValueError as error:
        raise InputError(
            f"material '{element.get('name')}' needs a number <{tag}> (got '{text}')"
        ) from error


def _shifted(key: str, number: str, digits: int) -> str:
    """Change the unit of a pressure: move the point, keep every digit."""
    return moved_point(number, digits if key.endswith("_pa") else 0)

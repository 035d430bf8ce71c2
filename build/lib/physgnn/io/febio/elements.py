"""What the readers and writers of FEBio's XML share: elements, lists, numbers."""

import math
from decimal import Decimal
from typing import Any
from xml.etree import ElementTree as ET

from physgnn.errors import InputError

AXES = "xyz"
CURVE = "1"
"""The id of the one load curve of the models written here."""


def add(
    parent: ET.Element, tag: str, text: str | None = None, /, **attributes: str
) -> ET.Element:
    """Append a child with a text and attributes to an element, and return it."""
    child = ET.SubElement(parent, tag, attributes)
    child.text = text
    return child


def named(
    root: ET.Element, where: str, value: str | None, *, attribute: str = "name"
) -> ET.Element | None:
    """Return the first element at a path that has this name, or None.

    XPath's own ``[@name='…']`` fails on names with quotation marks.
    """
    found = (e for e in root.findall(where) if e.get(attribute) == value)
    return next(found, None)


def listed(values: list[Any]) -> str:
    """Join numbers with commas, floats with all their digits."""
    return ",".join(map(repr, values))


def floats(element: ET.Element) -> list[float]:
    """Return the numbers of an element, which commas separate.

    Raises
    ------
    ValueError
        If one is no number.
    InputError
        If one is not finite.
    """
    values = [float(value) for value in (element.text or "").split(",")]
    if not all(map(math.isfinite, values)):
        raise InputError(f"<{element.tag}> must hold finite numbers (got {values})")
    return values


def axis_of(element: ET.Element) -> str:
    """Return the axis that an element's <dof> names; InputError if it names none."""
    dof = (element.findtext("dof") or "").strip()
    if dof not in tuple(AXES):
        raise InputError(
            f"'{element.get('name')}' needs a <dof> that is x, y or z (got '{dof}')"
        )
    return dof


def moved_point(number: float | str, digits: int) -> str:
    """Multiply a printed number by a power of ten: every digit stays as it is.

    Raises
    ------
    ValueError
        If it is no number.
    """
    text = number if isinstance(number, str) else repr(float(number))
    try:
        return str(Decimal(text).scaleb(digits))
    except ArithmeticError as error:
        raise ValueError(f"'{text}' is no number") from error

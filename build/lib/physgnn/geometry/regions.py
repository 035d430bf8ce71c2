"""The regions of a head: labels in a mesh, and their names."""

BRAIN, TUMOUR, VENTRICLE = 0, 1, 2
REGIONS = ("brain", "tumour", "ventricle")
"""Names, in the order of their labels."""


def region_name(label: int) -> str:
    """Return the name of a region; of one without, "region" and its label."""
    return REGIONS[label] if 0 <= label < len(REGIONS) else f"region {label}"


def region_label(name: str) -> int | None:
    """Return the label of a region by its name, or by its label in digits.

    None if it is neither.
    """
    if name in REGIONS:
        return REGIONS.index(name)
    return int(name) if name.isdecimal() else None

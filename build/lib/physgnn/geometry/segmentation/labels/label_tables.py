"""Which label means which tissue, by the name of a convention or in plain words."""

import re
from collections.abc import Collection, Mapping
from dataclasses import replace
from types import MappingProxyType

from physgnn.errors import InputError
from physgnn.geometry.segmentation.labels.anatomical_labels import ANATOMICAL
from physgnn.geometry.segmentation.labels.label_table import LabelTable
from physgnn.geometry.segmentation.labels.tumour_labels import MASKED, TUMOUR

__all__ = ["LABEL_TABLES", "MASKED", "LabelTable", "label_table", "resolved"]

ENTRY = re.compile(r"(\w+)=(\d+(?:\+\d+)*)")
# Of an atlas whose labels are all brain: its list is what the map holds.
ATLAS = "atlas"

SEGMENTED = LabelTable({"brain": (1,), "tumour": (2,), "ventricle": (3,)})
"""What ``physgnn segment`` writes."""

LABEL_TABLES: Mapping[str, LabelTable] = MappingProxyType(
    {
        "mask": LabelTable({"brain": (1,)}),
        "segment": SEGMENTED,
        **TUMOUR,
        **ANATOMICAL,
        ATLAS: LabelTable({"brain": (1,)}, closing_mm=4.0),
    }
)

MASK, BRATS = "mask", "brats"
# A brain mask with tumour and ventricles in it: label 1 is most of it, and more than
# any tumour has, ml.
MOST_BRAIN, LARGER_THAN_TUMOURS_ML = 0.75, 400.0
ENHANCING_2020, ENHANCING_2023 = 4, 3


def resolved(text: str, present: Mapping[int, float]) -> tuple[str, list[str]]:
    """Return which convention is meant where a name stands for several.

    Parameters
    ----------
    text : str
        As of `label_table`.
    present : mapping of label to ml
        The labels found.

    Returns
    -------
    str, list of str
        What to give to `label_table`, and a line that says what was decided.
    """
    if text == MASK and _is_segmented(present):
        meant = ", ".join(
            f"{labels[0]} {tissue}" for tissue, labels in SEGMENTED.labels.items()
        )
        return "segment", [f"labels: taken for those of physgnn segment ({meant})"]
    if text == ATLAS:
        return _atlas(present)
    if text != BRATS:
        return text, []
    if ENHANCING_2020 in present and ENHANCING_2023 in present:
        name = "brats-post"
    else:
        name = "brats-2023" if ENHANCING_2023 in present else "brats-2020"
    meanings = ", ".join(
        f"{label} {meaning}"
        for label, meaning in LABEL_TABLES[name].names.items()
        if label != MASKED
    )
    return name, [
        f"labels: brats taken for {name} ({meanings}), by the labels that are there; "
        "name another of brats-2013, brats-2020, brats-2023, brats-post, brats-ped, "
        "brats-men-rt and msd if that is wrong"
    ]


def _atlas(present: Collection[int]) -> tuple[str, list[str]]:
    """Return an atlas' labels, all of them brain; those below 0 are none."""
    labels = sorted(n for n in present if n > 0)
    if not labels:
        return ATLAS, []
    return f"{ATLAS},brain={'+'.join(map(str, labels))}", [
        f"labels: all {len(labels)} of the atlas taken for brain; name its ventricles "
        "with the brain, as in brain=1+2,ventricle=3, if it has them"
    ]


def _is_segmented(present: Mapping[int, float]) -> bool:
    """Return whether labels are those of ``physgnn segment``, by their volumes."""
    brain = present.get(SEGMENTED.labels["brain"][0], 0.0)
    return (
        len(present) > 1
        and all(SEGMENTED.tissue(label) is not None for label in present)
        and brain >= LARGER_THAN_TUMOURS_ML
        and brain >= MOST_BRAIN * sum(present.values())
    )


def label_table(text: str) -> LabelTable:
    """Return the table a user names or spells out.

    Parameters
    ----------
    text : str
        A name in ``LABEL_TABLES``, or such as ``"brain=1,tumour=4"``; several labels
        of a tissue are joined by a plus sign, ``"brain=1+2"``. A name may be followed
        by what differs from it, ``"freesurfer,tumour=99"``.

    Raises
    ------
    InputError
        If it is neither.
    """
    first, *rest = (entry.strip() for entry in text.split(","))
    if first not in LABEL_TABLES:
        return LabelTable(_spelled_out([first, *rest], text))
    base = LABEL_TABLES[first]
    if not rest:
        return base
    given = _spelled_out(rest, text)
    taken = {label for labels in given.values() for label in labels}
    kept = {
        tissue: tuple(n for n in labels if n not in taken)
        for tissue, labels in base.labels.items()
    }
    for tissue, labels in given.items():
        kept[tissue] = labels + (() if first == ATLAS else kept.get(tissue, ()))
    outside = tuple(n for n in base.outside if n not in taken)
    return replace(base, labels=kept, outside=outside)


def _spelled_out(entries: list[str], text: str) -> dict[str, tuple[int, ...]]:
    """Return the labels of each tissue from entries such as ``brain=1+2``."""
    found = [ENTRY.fullmatch(entry) for entry in entries]
    if len({entry[1] for entry in found if entry}) < len(entries):
        raise InputError(
            f"labels must be one of {', '.join(LABEL_TABLES)}, or such as "
            f"'brain=1+2,tumour=4', each tissue once (got '{text}')"
        )
    return {
        entry[1]: tuple(int(label) for label in entry[2].split("+"))
        for entry in found
        if entry
    }

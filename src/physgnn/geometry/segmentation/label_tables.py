"""Which label means which tissue, by the name of a convention or in plain words."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from physgnn.errors import InputError
from physgnn.geometry.regions import REGIONS

ENTRY = re.compile(r"(\w+)=(\d+(?:\+\d+)*)")


@dataclass(frozen=True)
class LabelTable:
    """How to read one kind of label map.

    Attributes
    ----------
    labels : mapping of tissue to labels
        One entry a tissue of ``REGIONS``, ``"brain"`` among them; a label belongs to
        one tissue.
    closing_mm : float
        Radius of the closing that fills sulci which have no label.
    names : mapping of label to str
        What labels are called in messages, where that helps.
    outside : tuple of int
        Labels that are known to lie outside of the brain; they are not meshed.
    needs_mask : bool
        Whether the convention leaves the healthy brain without a label.

    Raises
    ------
    InputError
        If any of this does not hold.
    """

    labels: Mapping[str, tuple[int, ...]]
    closing_mm: float = 0.0
    names: Mapping[int, str] = field(default_factory=dict)
    outside: tuple[int, ...] = ()
    needs_mask: bool = False

    def __post_init__(self) -> None:
        unknown = [name for name in self.labels if name not in REGIONS]
        if unknown or "brain" not in self.labels:
            raise InputError(
                f"labels are given for brain, and for tumour and ventricle if there "
                f"are any (got {', '.join(self.labels) or 'nothing'})"
            )
        every = [label for labels in self.labels.values() for label in labels]
        every += self.outside
        if len(set(every)) < len(every) or 0 in every:
            raise InputError(
                f"a label must be > 0 and belong to one tissue (got {sorted(every)})"
            )

    def tissue(self, label: int) -> str | None:
        """Return the tissue of a label, or None if the table does not name it."""
        return next((t for t, labels in self.labels.items() if label in labels), None)


# FreeSurferColorLUT.txt: white matter and cortex of cerebrum and cerebellum, deep
# grey matter, brain stem, vessels, lesions of white matter (25, 57, 77-79: those of
# ageing, not tumours), optic chiasm, fornix, corpus callosum, the parcels of the cortex
# and of the white matter below it, by Desikan (1000-4035) and by Destrieux
# (11100-14175); ventricles with their choroid plexus.
_FREESURFER = {
    "brain": (
        *(2, 3, 7, 8, 10, 11, 12, 13, 16, 17, 18, 25, 26, 27, 28, 30),
        *(41, 42, 46, 47, 49, 50, 51, 52, 53, 54, 57, 58, 59, 60, 62),
        *(77, 78, 79, 80, 85, *range(250, 256)),
        *(n for i in (1000, 2000, 3000, 4000) for n in range(i, i + 36)),
        *(n for i in (11100, 12100, 13100, 14100) for n in range(i, i + 76)),
        *(5001, 5002),
    ),
    "ventricle": (4, 5, 14, 15, 31, 43, 44, 63, 72),
}
# Exterior, cerebrospinal fluid, air, skull, other tissues of the head, eyes; and
# 501-532, by which SynthSeg's training maps name what lies around the brain.
_FREESURFER_OUTSIDE = (
    *(1, 6, 24, 40, 45, 118, 119, 120, 121, 122, 130, 165, 257, 258, 259),
    *range(501, 533),
)
_LESIONS = {25: "lesion of white matter", 57: "lesion of white matter"}

# BraTS leaves the healthy brain unlabelled: 5 is what a brain mask adds. Swollen brain
# (oedema) is brain. Numbers: Baid et al., arXiv 2107.02314 (to 2021); the challenge's
# page of 2023; de Verdier et al., arXiv 2405.18368 (after treatment); Simpson et al.,
# arXiv 1902.09063 (MSD, task 1).
MASKED = 5
_MASKED = {MASKED: "from the brain mask"}
_BRATS_2020 = LabelTable(
    {"brain": (MASKED, 2), "tumour": (1, 4)},
    names={1: "necrotic core", 2: "oedema", 4: "enhancing tumour", **_MASKED},
    needs_mask=True,
)
_BRATS_2023 = LabelTable(
    {"brain": (MASKED, 2), "tumour": (1, 3)},
    names={1: "necrotic core", 2: "oedema", 3: "enhancing tumour", **_MASKED},
    needs_mask=True,
)
_BRATS_POST = LabelTable(
    {"brain": (MASKED, 2), "tumour": (1, 3), "ventricle": (4,)},
    names={
        1: "non-enhancing core",
        2: "oedema",
        3: "enhancing tumour",
        4: "resection cavity, filled with fluid as a ventricle is",
        **_MASKED,
    },
    needs_mask=True,
)
_MSD = LabelTable(
    {"brain": (MASKED, 1), "tumour": (2, 3)},
    names={1: "oedema", 2: "non-enhancing core", 3: "enhancing tumour", **_MASKED},
    needs_mask=True,
)

SEGMENTED = LabelTable({"brain": (1,), "tumour": (2,), "ventricle": (3,)})
"""What ``physgnn segment`` writes."""

LABEL_TABLES: Mapping[str, LabelTable] = MappingProxyType(
    {
        "mask": LabelTable({"brain": (1,)}),
        "segment": SEGMENTED,
        # whichever of the next three the labels found are of, see `resolved`
        "brats": LabelTable(
            {"brain": (MASKED, 2), "tumour": (1, 3, 4)}, needs_mask=True
        ),
        "brats-2020": _BRATS_2020,
        "brats-2023": _BRATS_2023,
        "brats-post": _BRATS_POST,
        "msd": _MSD,
        "freesurfer": LabelTable(
            _FREESURFER, closing_mm=4.0, names=_LESIONS, outside=_FREESURFER_OUTSIDE
        ),
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
        "name another of brats-2020, brats-2023, brats-post and msd if that is wrong"
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
        of a tissue are joined by a plus sign, ``"brain=1+2"``.

    Raises
    ------
    InputError
        If it is neither.
    """
    if text in LABEL_TABLES:
        return LABEL_TABLES[text]
    entries = [ENTRY.fullmatch(entry.strip()) for entry in text.split(",")]
    names = [entry[1] for entry in entries if entry]
    if len(set(names)) < len(entries):
        raise InputError(
            f"labels must be one of {', '.join(LABEL_TABLES)}, or such as "
            f"'brain=1+2,tumour=4', each tissue once (got '{text}')"
        )
    return LabelTable(
        {
            entry[1]: tuple(int(label) for label in entry[2].split("+"))
            for entry in entries
            if entry
        }
    )

"""Which label means which tissue, by the name of a convention or in plain words."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
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

    Raises
    ------
    InputError
        If any of this does not hold.
    """

    labels: Mapping[str, tuple[int, ...]]
    closing_mm: float = 0.0

    def __post_init__(self) -> None:
        unknown = [name for name in self.labels if name not in REGIONS]
        if unknown or "brain" not in self.labels:
            raise InputError(
                f"labels are given for brain, and for tumour and ventricle if there "
                f"are any (got {', '.join(self.labels) or 'nothing'})"
            )
        every = [label for labels in self.labels.values() for label in labels]
        if len(set(every)) < len(every) or 0 in every:
            raise InputError(
                f"a label must be > 0 and belong to one tissue (got {sorted(every)})"
            )


# FreeSurferColorLUT.txt: white matter and cortex of cerebrum and cerebellum, deep
# grey matter, brain stem, vessels, white matter lesions, optic chiasm, fornix, corpus
# callosum, and the parcels of the cortex; ventricles with their choroid plexus.
_FREESURFER = {
    "brain": (
        *(2, 3, 7, 8, 10, 11, 12, 13, 16, 17, 18, 26, 28, 30),
        *(41, 42, 46, 47, 49, 50, 51, 52, 53, 54, 58, 60, 62),
        *(77, 78, 79, 80, 85, *range(250, 256)),
        *(*range(1000, 1036), *range(2000, 2036)),
    ),
    "tumour": (25, 57),
    "ventricle": (4, 5, 14, 15, 31, 43, 44, 63, 72),
}

LABEL_TABLES: Mapping[str, LabelTable] = MappingProxyType(
    {
        "mask": LabelTable({"brain": (1,)}),
        # 1 necrotic core, 2 oedema (swollen brain), 3 or 4 enhancing tumour. BraTS
        # leaves the rest of the brain unlabelled: 5 is what a brain mask adds.
        "brats": LabelTable({"brain": (5, 2), "tumour": (1, 3, 4)}),
        "freesurfer": LabelTable(_FREESURFER, closing_mm=4.0),
    }
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

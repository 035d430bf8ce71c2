"""Which label means which tissue, by the name of a convention or in plain words."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from physgnn.errors import InputError

TISSUES = ("brain", "tumour", "ventricle")
Labels = Mapping[str, tuple[int, ...]]


@dataclass(frozen=True)
class LabelTable:
    """How to read one kind of label map.

    Attributes
    ----------
    labels : mapping of tissue to labels
        ``"brain"`` holds all that is brain and nothing else listed.
    closing_mm : float
        Radius of the closing that fills unlabelled sulci of the brain.
    source : str
        Where the labels are defined.
    """

    labels: Labels
    closing_mm: float
    source: str


# FreeSurferColorLUT.txt: cerebral and cerebellar white matter and cortex, deep grey
# matter, brain stem, ventral DC, white matter lesions, corpus callosum.
_ASEG_BRAIN = (
    *(2, 3, 7, 8, 10, 11, 12, 13, 16, 17, 18, 26, 28, 30, 31, 77, 80, 85),
    *(41, 42, 46, 47, 49, 50, 51, 52, 53, 54, 58, 60, 62, 63, 78, 79),
    *range(251, 256),
    *range(1000, 1036),
    *range(2000, 2036),
)

LABEL_TABLES: Mapping[str, LabelTable] = MappingProxyType(
    {
        "mask": LabelTable({"brain": (1,)}, 0.0, "a brain mask, 0 and 1"),
        "brats": LabelTable(
            {"brain": (5,), "tumour": (1, 3, 4), "ventricle": (6,)},
            0.0,
            "BraTS: 1 necrotic core, 3 or 4 enhancing tumour; its label 2, oedema, is "
            "brain. BraTS labels no brain: add 5 brain and 6 ventricle",
        ),
        "freesurfer": LabelTable(
            {"brain": _ASEG_BRAIN, "tumour": (99,), "ventricle": (4, 5, 43, 44)},
            4.0,
            "FreeSurfer aseg, aparc+aseg or SynthSeg; 99 is its label for a lesion",
        ),
    }
)

"""Conventions that mark a tumour and leave the healthy brain without a label.

Swollen brain (oedema) is brain. Numbers: Menze et al., IEEE Trans. Med. Imaging 34,
2015 (BraTS to 2016); Baid et al., arXiv 2107.02314 (2017 to 2021); the challenge's page
of 2023; de Verdier et al., arXiv 2405.18368 (after treatment, 2024); Kazerooni et al.,
arXiv 2404.15009 (children, 2024); LaBella et al., arXiv 2405.18383 (meningioma before
radiotherapy, 2024); Simpson et al., arXiv 1902.09063 (MSD, task 1).
"""

from collections.abc import Mapping
from types import MappingProxyType

from physgnn.geometry.segmentation.labels.label_table import LabelTable

MASKED = 5  # what a brain mask adds


def _table(
    oedema: tuple[int, ...], names: Mapping[int, str], cavity: tuple[int, ...] = ()
) -> LabelTable:
    """Return a table whose named labels are tumour but for oedema and cavity."""
    tumour = tuple(n for n in names if n not in (*oedema, *cavity))
    labels = {"brain": (MASKED, *oedema), "tumour": tumour}
    if cavity:
        labels["ventricle"] = cavity
    return LabelTable(
        labels, names={**names, MASKED: "from the brain mask"}, needs_mask=True
    )


CAVITY = "resection cavity"
TUMOUR: Mapping[str, LabelTable] = MappingProxyType(
    {
        # whichever of the others the labels found are of, see `resolved`
        "brats": LabelTable(
            {"brain": (MASKED, 2), "tumour": (1, 3, 4)}, needs_mask=True
        ),
        "brats-2013": _table(
            (2,),
            {
                1: "necrotic core",
                2: "oedema",
                3: "non-enhancing tumour",
                4: "enhancing tumour",
            },
        ),
        "brats-2020": _table(
            (2,), {1: "necrotic core", 2: "oedema", 4: "enhancing tumour"}
        ),
        "brats-2023": _table(
            (2,), {1: "necrotic core", 2: "oedema", 3: "enhancing tumour"}
        ),
        # the cavity is filled with fluid as a ventricle is
        "brats-post": _table(
            (2,),
            {1: "non-enhancing core", 2: "oedema", 3: "enhancing tumour", 4: CAVITY},
            (4,),
        ),
        "brats-ped": _table(
            (4,),
            {
                1: "enhancing tumour",
                2: "non-enhancing tumour",
                3: "cystic component",
                4: "oedema",
            },
        ),
        "brats-men-rt": _table((), {1: "gross tumour volume"}),
        "msd": _table(
            (1,), {1: "oedema", 2: "non-enhancing core", 3: "enhancing tumour"}
        ),
    }
)

"""Conventions that name all of a brain: FreeSurfer's and those of atlases.

FreeSurfer's numbers are those of FreeSurferColorLUT.txt; SynthSeg writes a part of them
(Billot et al., Med. Image Anal. 86, 2023), and adds 501 to 532 for what lies around the
brain in its training maps. Neuromorphometrics' are those of the MICCAI 2012 challenge
on multi-atlas labelling, which SPM and SLANT write. Harvard-Oxford's are the indices of
FSL's ``sub-maxprob`` maps.
"""

from collections.abc import Mapping
from types import MappingProxyType

from physgnn.geometry.segmentation.labels.label_table import LabelTable

# Cortex and the white matter below it, by Desikan (1000-4035) and by Destrieux
# (11100-14175), and what is left unsegmented of the white matter (5001, 5002).
_LEFT_PARCELS = (*range(1000, 1036), *range(11100, 11176))
_RIGHT_PARCELS = (*range(2000, 2036), *range(12100, 12176))
_WHITE_PARCELS = (
    *(n for i in (3000, 4000) for n in range(i, i + 36)),
    *(n for i in (13100, 14100) for n in range(i, i + 76)),
    *(5001, 5002),
)
# White matter, cortex, deep grey matter, vessels, lesions of white matter (25, 57, 78,
# 79, 81, 82 and 100-117: those of ageing, not tumours), hippocampal subfields.
_LEFT = (
    *(2, 3, 9, 10, 11, 12, 13, 17, 18, 19, 20, 25, 26, 27, 28, 29, 30, *range(32, 40)),
    *(73, 78, 81, 83, 91, 96, *range(100, 109), 136, 138, 155, 157, 159, 161, 163),
    *(193, 194, 195, 196),
    *_LEFT_PARCELS,
)
_RIGHT = (
    *(41, 42, 48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60, 61, 62),
    *(*range(64, 72), 74, 79, 82, 84, 92, 97, *range(109, 118), 137, 139, 156, 158),
    *(160, 162, 164, 197, 198, 199, 200),
    *_RIGHT_PARCELS,
)
_CEREBELLUM = (7, 8, 46, 47, 171, 172, 179, 183, 184, *range(601, 633))
# Brain stem and its parts, corpus callosum, fornix, optic chiasm, hypothalamus, nuclei
# of amygdala and thalamus, subfields of the hippocampus without a side.
_MIDLINE = (
    *(16, 77, 80, 85, 86, 170, 173, 174, 175, 178, 192, *range(201, 213)),
    *(*range(214, 221), 222, 223, 225, *range(226, 247), *range(250, 256)),
    *(*range(801, 847), *range(7001, 7021), *range(8001, 8015), *range(8101, 8235)),
)
_LEFT_VENTRICLE, _RIGHT_VENTRICLE = (4, 5, 31, 75), (43, 44, 63, 76)
_VENTRICLES: dict[int, str] = {
    **dict.fromkeys(_LEFT_VENTRICLE, "left lateral ventricle"),
    **dict.fromkeys(_RIGHT_VENTRICLE, "right lateral ventricle"),
    **{14: "third ventricle", 15: "fourth ventricle", 72: "fifth ventricle"},
    **{213: "lateral ventricle", 221: "lateral ventricle"},
}
_LESIONS = dict.fromkeys((25, 57), "lesion of white matter")
# Exterior, cerebrospinal fluid, dura, skull, other tissues of the head, eyes, spinal
# cord.
_OUTSIDE = (
    *(1, 6, 21, 22, 23, 24, 40, 45, 98, *range(118, 136), *range(140, 155)),
    *(165, 166, 224, 257, 258, 259, 260, 261, 262, 263, 264, 265, *range(501, 533)),
)
FREESURFER = LabelTable(
    {
        "brain": (*_LEFT, *_RIGHT, *_WHITE_PARCELS, *_CEREBELLUM, *_MIDLINE),
        "ventricle": tuple(_VENTRICLES),
    },
    closing_mm=4.0,
    names={**_LESIONS, **_VENTRICLES},
    outside=_OUTSIDE,
    left=(3, 19, 20, *_LEFT_PARCELS),
    right=(42, 55, 56, *_RIGHT_PARCELS),
    cerebellum=_CEREBELLUM,
)

# Right before left in every pair: accumbens, amygdala, caudate, white matter,
# hippocampus, pallidum, putamen, thalamus, ventral diencephalon, vessel, forebrain;
# then the parcels of the cortex, right even and left odd.
_NM_RIGHT = (
    *(23, 31, 36, 44, 47, 55, 57, 59, 61, 63, 76),
    *range(100, 208, 2),
)
_NM_LEFT = (
    *(30, 32, 37, 45, 48, 56, 58, 60, 62, 64, 75),
    *range(101, 208, 2),
)
_NM_CEREBELLUM = (38, 39, 40, 41, 71, 72, 73)
_NM_VENTRICLES = {
    **dict.fromkeys((49, 51), "right lateral ventricle"),
    **dict.fromkeys((50, 52), "left lateral ventricle"),
    **{4: "third ventricle", 11: "fourth ventricle"},
}
_NEUROMORPHOMETRICS = LabelTable(
    {
        "brain": (*_NM_LEFT, *_NM_RIGHT, *_NM_CEREBELLUM, 35, 69),
        "ventricle": tuple(_NM_VENTRICLES),
    },
    closing_mm=4.0,
    names=_NM_VENTRICLES,
    outside=(46,),
    left=tuple(range(101, 208, 2)),
    right=tuple(range(100, 208, 2)),
    cerebellum=_NM_CEREBELLUM,
)

_HO_LEFT, _HO_RIGHT = (1, 2, 4, 5, 6, 7, 9, 10, 11), (12, 13, *range(15, 22))
_HO_VENTRICLES = {3: "left lateral ventricle", 14: "right lateral ventricle"}
_HARVARD_OXFORD = LabelTable(
    {"brain": (*_HO_LEFT, *_HO_RIGHT, 8), "ventricle": tuple(_HO_VENTRICLES)},
    closing_mm=4.0,
    names=_HO_VENTRICLES,
    left=(2,),
    right=(13,),
)

ANATOMICAL: Mapping[str, LabelTable] = MappingProxyType(
    {
        "freesurfer": FREESURFER,
        "synthseg": FREESURFER,
        "neuromorphometrics": _NEUROMORPHOMETRICS,
        "harvard-oxford": _HARVARD_OXFORD,
    }
)

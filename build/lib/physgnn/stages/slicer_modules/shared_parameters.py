"""Parameters and kinds of files that several modules of 3D Slicer share."""

from physgnn.stages.slicer_modules import jobs
from physgnn.stages.slicer_modules.parameters import Parameter, ReturnedValue

VOLUME, POINTS, MODEL = (".nii.gz",), (".fcsv",), (".vtp",)
TRANSFORM, MESH = (".h5",), (".vtu",)
LABELS = {"type": "label"}
MARKUPS = {"coordinateSystem": "ras", "multiple": "true"}
STATUS = ReturnedValue(jobs.STATUS, "Status")
REASON = ReturnedValue(jobs.REASON, "Because")
BOUND = ReturnedValue("bound_mm", "Error at most, mm")

CASE = Parameter(
    "file",
    "mesh",
    "Mesh",
    "The patient's mesh, VTU, made by the module Mesh.",
    extensions=MESH,
)
SHIFT = Parameter(
    "file",
    jobs.SHIFT,
    "Displacement",
    "The mesh with its displacement, VTU, for the module Warp.",
    is_output=True,
    extensions=MESH,
)
OUTPUTS = (
    Parameter(
        "transform",
        "transform",
        "Transform",
        "Takes the preoperative scan, and all of its plan, to where the brain is now.",
        is_output=True,
        extensions=TRANSFORM,
    ),
    Parameter(
        "geometry",
        "surfaces",
        "Deformed surfaces",
        "Brain and tumour where they are now.",
        is_output=True,
        extensions=MODEL,
    ),
    SHIFT,
)
REFERENCE = Parameter(
    "image",
    "image",
    "Reference volume",
    "The transform gets the voxels of this volume; without it, 2 mm around the brain.",
    extensions=VOLUME,
    is_advanced=True,
)

"""The modules that 3D Slicer shows: one row each; the XML and the launchers follow.

The parameters of a row are arguments of its stage, but for what `jobs` translates.
"""

from physgnn import choices, stages
from physgnn.stages.slicer_modules import jobs
from physgnn.stages.slicer_modules.parameters import Module, Parameter, ReturnedValue

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

ROWS = (
    Module(
        "PhysGNNSegment",
        "segment",
        "Segment brain",
        "Find the brain in a T1.",
        (
            Parameter("image", "image", "T1", "The scan.", extensions=VOLUME),
            Parameter(
                "image",
                "segmentation",
                "Segmentation",
                "The label map.",
                is_output=True,
                extensions=VOLUME,
                attributes=LABELS,
            ),
        ),
        (STATUS,),
        jobs.segment,
    ),
    Module(
        "PhysGNNMesh",
        "mesh",
        "Mesh",
        "Fill a label map with tetrahedra.",
        (
            Parameter(
                "image",
                "segmentation",
                "Label map",
                "Brain, and tumours inside.",
                extensions=VOLUME,
                attributes=LABELS,
            ),
            Parameter(
                "string",
                "labels",
                "Labels",
                "Which label is which tissue: mask, freesurfer, brats, or such as "
                "brain=1,tumour=2.",
                default="mask",
            ),
            Parameter(
                "pointfile",
                "craniotomy",
                "Craniotomy",
                "A point on the cortex in the middle of the craniotomy; of several, "
                "their mean. The skull holds the brain elsewhere.",
                extensions=POINTS,
                attributes=MARKUPS,
            ),
            Parameter(
                "double",
                "radius_mm",
                "Free radius, mm",
                "The skull holds what is farther than this from the craniotomy.",
                default="70",
            ),
            Parameter(
                "image",
                "brain_mask",
                "Brain mask",
                "Not 0 inside the brain, for label maps of the tumour alone.",
                extensions=VOLUME,
                is_advanced=True,
            ),
            Parameter(
                "integer",
                "target_points",
                "Points",
                "About how many points the mesh shall have.",
                default="10000",
                is_advanced=True,
            ),
            Parameter(
                "boolean",
                "ignore_labels",
                "Ignore other labels",
                "Leave labels that are not named out of the mesh.",
                default="false",
                is_advanced=True,
            ),
            Parameter(
                "boolean",
                "any_size",
                "Any size",
                "Accept a brain of less than 50 or more than 2500 ml.",
                default="false",
                is_advanced=True,
            ),
            Parameter(
                "file",
                "mesh",
                "Mesh",
                "The mesh, VTU.",
                is_output=True,
                extensions=MESH,
            ),
            Parameter(
                "geometry",
                "surfaces",
                "Surfaces",
                "The surfaces of the mesh, to look at.",
                is_output=True,
                extensions=MODEL,
            ),
        ),
        (STATUS, ReturnedValue("points", "Points")),
        jobs.mesh,
    ),
    Module(
        "PhysGNNRegister",
        "register",
        "Register",
        "Find the displacement of the whole brain from what was measured.",
        (
            CASE,
            Parameter(
                "pointfile",
                "points",
                "Points before",
                "Points of the cortex in the preoperative scan.",
                extensions=POINTS,
                attributes=MARKUPS,
            ),
            Parameter(
                "pointfile",
                "target",
                "Points after",
                "Where they are now: the same labels, or the same order.",
                extensions=POINTS,
                attributes=MARKUPS,
            ),
            Parameter(
                "geometry",
                "surface",
                "Exposed surface",
                "Where the exposed surface is now, instead of points.",
                extensions=MODEL,
            ),
            Parameter(
                "double",
                "noise_mm",
                "Noise, mm",
                "Standard deviation of every measured coordinate.",
                default="1.0",
            ),
            Parameter(
                "string-enumeration",
                "skull",
                "Skull",
                "How the skull holds the brain.",
                default="fixed",
                elements=choices.names("Skull"),
                is_advanced=True,
            ),
            REFERENCE,
            *OUTPUTS,
        ),
        (
            STATUS,
            REASON,
            BOUND,
            ReturnedValue("misfit_mm", "Misfit, mm"),
            ReturnedValue("held_out_mm", "Misfit of points held out, mm"),
        ),
        jobs.register,
    ),
    Module(
        "PhysGNNWarp",
        "warp",
        "Warp",
        "Deform a volume as Register or Predict found.",
        (
            Parameter(
                "image", "image", "Volume", "The volume at rest.", extensions=VOLUME
            ),
            Parameter(
                "file",
                "prediction",
                "Displacement",
                "The VTU that Register or Predict wrote.",
                extensions=MESH,
            ),
            Parameter(
                "boolean",
                "labels",
                "Label map",
                "Treat the volume as a label map.",
                default="false",
            ),
            Parameter(
                "image",
                "deformed",
                "Deformed volume",
                "The volume where the brain is now.",
                is_output=True,
                extensions=VOLUME,
            ),
            Parameter(
                "transform",
                "transform",
                "Transform",
                "The same as a transform.",
                is_output=True,
                extensions=TRANSFORM,
            ),
            Parameter(
                "image",
                "jacobian",
                "Change of volume",
                "Volume now over volume before, at every voxel.",
                is_output=True,
                extensions=VOLUME,
                is_advanced=True,
            ),
        ),
        (STATUS,),
        jobs.warp,
    ),
    Module(
        "PhysGNNPredict",
        "predict",
        "Predict",
        "Predict the displacement under a force, in milliseconds.",
        (
            Parameter(
                "directory",
                "run",
                "Run",
                "The folder of a trained model; empty for the bundled brain.",
            ),
            Parameter(
                "pointfile",
                "points",
                "Points to push",
                "Points of the cortex that share the force.",
                extensions=POINTS,
                attributes=MARKUPS,
            ),
            Parameter(
                "double-vector",
                "force_n",
                "Force, N",
                "Along right, anterior and superior.",
                default="0,0,-1",
            ),
            Parameter(
                "file",
                "load",
                "Load case",
                "A load case, JSON, instead of points.",
                extensions=(".json",),
                is_advanced=True,
            ),
            Parameter(
                "double",
                "tolerance_mm",
                "Tolerance, mm",
                "Repair the prediction where its error may exceed this; 0 for never.",
                default="0",
                is_advanced=True,
            ),
            REFERENCE,
            *OUTPUTS,
        ),
        (STATUS, REASON, BOUND),
        jobs.predict,
    ),
)


def modules() -> tuple[Module, ...]:
    """Return the modules whose stage there is."""
    there = set(stages.__all__)
    return tuple(row for row in ROWS if row.command in there)

"""Modules of 3D Slicer for the operating theatre: Register, Predict and Warp."""

from physgnn import choices
from physgnn.stages.slicer_modules import jobs
from physgnn.stages.slicer_modules.parameters import Module, Parameter, ReturnedValue
from physgnn.stages.slicer_modules.shared_parameters import (
    BOUND,
    CASE,
    MARKUPS,
    MESH,
    MODEL,
    OUTPUTS,
    POINTS,
    REASON,
    REFERENCE,
    STATUS,
    TRANSFORM,
    VOLUME,
)

REGISTER_MODULE = Module(
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
)

WARP_MODULE = Module(
    "PhysGNNWarp",
    "warp",
    "Warp",
    "Deform a volume as Register or Predict found.",
    (
        Parameter("image", "image", "Volume", "The volume at rest.", extensions=VOLUME),
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
)

PREDICT_MODULE = Module(
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
)

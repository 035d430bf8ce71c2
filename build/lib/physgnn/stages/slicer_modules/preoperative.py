"""Modules of 3D Slicer for the time before the operation: Segment and Mesh."""

from physgnn.stages.slicer_modules import jobs
from physgnn.stages.slicer_modules.parameters import Module, Parameter, ReturnedValue
from physgnn.stages.slicer_modules.shared_parameters import (
    LABELS,
    MARKUPS,
    MESH,
    MODEL,
    POINTS,
    STATUS,
    VOLUME,
)

SEGMENT_MODULE = Module(
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
)

MESH_MODULE = Module(
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
)

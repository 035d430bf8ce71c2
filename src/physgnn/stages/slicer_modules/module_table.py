"""The modules that 3D Slicer shows: one row each; the XML and the launchers follow.

The parameters of a row are arguments of its stage, but for what `jobs` translates.
"""

from physgnn import stages
from physgnn.stages.slicer_modules.intraoperative import (
    PREDICT_MODULE,
    REGISTER_MODULE,
    WARP_MODULE,
)
from physgnn.stages.slicer_modules.parameters import Module
from physgnn.stages.slicer_modules.preoperative import MESH_MODULE, SEGMENT_MODULE

ROWS = (SEGMENT_MODULE, MESH_MODULE, REGISTER_MODULE, WARP_MODULE, PREDICT_MODULE)


def modules() -> tuple[Module, ...]:
    """Return the modules whose stage there is."""
    there = set(dir(stages))
    return tuple(row for row in ROWS if row.command in there)

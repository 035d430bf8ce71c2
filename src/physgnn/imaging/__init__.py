"""From a displacement on a mesh to images: fields, transforms, warped scans."""

from physgnn.imaging.field import (
    DisplacementField,
    forward_field,
    grid_around,
    inverse_field,
    round_trip_mm,
)
from physgnn.imaging.jacobian import Folding, folding, jacobian_image
from physgnn.imaging.slices import before_after
from physgnn.imaging.warp import warp

__all__ = [
    "DisplacementField",
    "Folding",
    "before_after",
    "folding",
    "forward_field",
    "grid_around",
    "inverse_field",
    "jacobian_image",
    "round_trip_mm",
    "warp",
]

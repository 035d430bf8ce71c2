"""From a displacement on a mesh to images: fields, transforms, warped scans."""

from physgnn.imaging.field import (
    FADE_PER_DISPLACEMENT,
    DisplacementField,
    forward_field,
    grid_around,
    inverse_field,
    round_trip_mm,
)
from physgnn.imaging.image_warping import warp
from physgnn.imaging.jacobian import Folding, folding, jacobian_image
from physgnn.imaging.labels import deformed_labels
from physgnn.imaging.slices import before_after, slices_of_shift

__all__ = [
    "FADE_PER_DISPLACEMENT",
    "DisplacementField",
    "Folding",
    "before_after",
    "deformed_labels",
    "folding",
    "forward_field",
    "grid_around",
    "inverse_field",
    "jacobian_image",
    "round_trip_mm",
    "slices_of_shift",
    "warp",
]

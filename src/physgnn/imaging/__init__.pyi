"""The names that `physgnn.imaging` exports, and where each is."""

from .field import FADE_PER_DISPLACEMENT as FADE_PER_DISPLACEMENT
from .field import DisplacementField as DisplacementField
from .field import forward_field as forward_field
from .field import grid_around as grid_around
from .field import inverse_field as inverse_field
from .field import round_trip_mm as round_trip_mm
from .image_warping import warp as warp
from .jacobian import Folding as Folding
from .jacobian import folding as folding
from .jacobian import jacobian_image as jacobian_image
from .labels import deformed_labels as deformed_labels
from .slices import before_after as before_after
from .slices import slices_of_shift as slices_of_shift

__all__: list[str]

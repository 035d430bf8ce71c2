"""The names that `physgnn.mechanics.materials` exports, and where each is."""

from .mooney_rivlin import MooneyRivlin as MooneyRivlin
from .neo_hookean import NeoHookean as NeoHookean
from .ogden import Ogden as Ogden
from .table import LAWS as LAWS
from .table import Material as Material
from .table import material_from_config as material_from_config
from .tissues import TISSUES as TISSUES
from .tissues import Tissue as Tissue

__all__: list[str]

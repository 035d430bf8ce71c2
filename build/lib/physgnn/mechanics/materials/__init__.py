"""Hyperelastic materials: one short file a law, one table of all."""

from physgnn.mechanics.materials.mooney_rivlin import MooneyRivlin
from physgnn.mechanics.materials.neo_hookean import NeoHookean
from physgnn.mechanics.materials.ogden import Ogden
from physgnn.mechanics.materials.table import LAWS, Material, material_from_config
from physgnn.mechanics.materials.tissues import TISSUES, Tissue

__all__ = [
    "LAWS",
    "TISSUES",
    "Material",
    "MooneyRivlin",
    "NeoHookean",
    "Ogden",
    "Tissue",
    "material_from_config",
]

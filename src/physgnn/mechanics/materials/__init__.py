"""Hyperelastic materials: one short file a law, one table of all."""

from physgnn.mechanics.materials.neo_hookean import NeoHookean
from physgnn.mechanics.materials.table import LAWS, Material, material_from_config

__all__ = ["LAWS", "Material", "NeoHookean", "material_from_config"]

"""Settings from TOML files: every key checked, every mistake one clear line."""

from physgnn.config.materials import read_materials
from physgnn.config.point_sets import read_point_sets
from physgnn.config.simulation import read_membranes, read_preset
from physgnn.config.tables import read_as, read_toml
from physgnn.config.training import read_training

__all__ = [
    "read_as",
    "read_materials",
    "read_membranes",
    "read_point_sets",
    "read_preset",
    "read_toml",
    "read_training",
]

"""Settings from TOML files: every key checked, every mistake one clear line."""

from physgnn.config.simulation import read_materials, read_point_sets, read_preset
from physgnn.config.tables import check_keys, from_table, read_toml
from physgnn.config.training import read_training

__all__ = [
    "check_keys",
    "from_table",
    "read_materials",
    "read_point_sets",
    "read_preset",
    "read_toml",
    "read_training",
]

"""The names that `physgnn.config` exports, and where each is."""

from .materials import read_materials as read_materials
from .point_sets import read_point_sets as read_point_sets
from .simulation import read_membranes as read_membranes
from .simulation import read_preset as read_preset
from .tables import read_as as read_as
from .tables import read_toml as read_toml
from .training import read_training as read_training

__all__: list[str]

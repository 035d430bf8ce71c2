"""The names that `physgnn.io` exports, and where each is."""

from .load_case import read_load_case as read_load_case
from .load_case import read_load_path as read_load_path
from .load_case import write_load_case as write_load_case
from .surfaces.formats import SURFACE_READERS as SURFACE_READERS
from .surfaces.formats import read_surface as read_surface
from .vtk.vtu import read_mesh as read_mesh
from .vtk.vtu import write_mesh as write_mesh
from .vtk.vtu import write_prediction as write_prediction

__all__: list[str]

"""Files in and out: surfaces, meshes with their point sets, load cases, predictions.

Every reader raises InputError for a file that is not what its name says; every
writer leaves a whole file or none.
"""

from physgnn.io.load_case import read_load_case, read_load_path, write_load_case
from physgnn.io.surfaces.formats import SURFACE_READERS, read_surface
from physgnn.io.vtk.vtu import read_mesh, write_mesh, write_prediction

__all__ = [
    "SURFACE_READERS",
    "read_load_case",
    "read_load_path",
    "read_mesh",
    "read_surface",
    "write_load_case",
    "write_mesh",
    "write_prediction",
]

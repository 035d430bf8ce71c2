"""The names that `physgnn.geometry` exports, and where each is."""

from .boundary import boundary_faces as boundary_faces
from .boundary import boundary_points as boundary_points
from .boundary import boundary_surface as boundary_surface
from .meshing.cell_quality import Quality as Quality
from .meshing.cell_quality import check_quality as check_quality
from .meshing.cell_quality import quality as quality
from .meshing.tetrahedra import paper_max_volume as paper_max_volume
from .meshing.tetrahedra import tetrahedralize as tetrahedralize
from .normals import face_normals as face_normals
from .normals import vertex_normals as vertex_normals
from .point_sets import RULES as RULES
from .point_sets import Complement as Complement
from .point_sets import HalfSpace as HalfSpace
from .point_sets import Nearest as Nearest
from .point_sets import Rule as Rule
from .point_sets import Sphere as Sphere
from .point_sets import Union as Union
from .point_sets import select as select
from .surface import Surface as Surface
from .surface import edge_lengths as edge_lengths
from .surface import edges as edges
from .surface import merge as merge
from .surface import merge_points as merge_points
from .surface import volume as volume
from .surfaces.checks import check_nested as check_nested
from .surfaces.checks import check_surface as check_surface
from .surfaces.checks import contains as contains
from .synthetic.phantom import Phantom as Phantom
from .synthetic.phantom import mni152_phantom as mni152_phantom
from .tetmesh import TetMesh as TetMesh
from .tetmesh import without_unused_points as without_unused_points

__all__: list[str]

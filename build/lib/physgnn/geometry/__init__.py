"""Surfaces, tetrahedral meshes, point sets: everything before mechanics."""

from physgnn.geometry.boundary import boundary_faces, boundary_points, boundary_surface
from physgnn.geometry.meshing.cell_quality import Quality, check_quality, quality
from physgnn.geometry.meshing.tetrahedra import paper_max_volume, tetrahedralize
from physgnn.geometry.normals import face_normals, vertex_normals
from physgnn.geometry.point_sets import (
    RULES,
    Complement,
    HalfSpace,
    Nearest,
    Rule,
    Sphere,
    Union,
    select,
)
from physgnn.geometry.surface import (
    Surface,
    edge_lengths,
    edges,
    merge,
    merge_points,
    volume,
)
from physgnn.geometry.surfaces.checks import check_nested, check_surface, contains
from physgnn.geometry.synthetic.phantom import Phantom, mni152_phantom
from physgnn.geometry.tetmesh import TetMesh, without_unused_points

__all__ = [
    "RULES",
    "Complement",
    "HalfSpace",
    "Nearest",
    "Phantom",
    "Quality",
    "Rule",
    "Sphere",
    "Surface",
    "TetMesh",
    "Union",
    "boundary_faces",
    "boundary_points",
    "boundary_surface",
    "check_nested",
    "check_quality",
    "check_surface",
    "contains",
    "edge_lengths",
    "edges",
    "face_normals",
    "merge",
    "merge_points",
    "mni152_phantom",
    "paper_max_volume",
    "quality",
    "select",
    "tetrahedralize",
    "vertex_normals",
    "volume",
    "without_unused_points",
]

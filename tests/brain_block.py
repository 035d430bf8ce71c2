"""A block of the template's brain: a mesh of little that scans show structure in."""

from dataclasses import replace

import numpy as np

from meshes import block_mesh
from physgnn.arrays import FloatArray
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.tetmesh import TetMesh

CORNER, SIDE = np.array([5.0, -30.0, 0.0]), 60.0
VOXEL = 2.0


def voxels() -> ImageGrid:
    """Voxels around the block, none with its centre in a face of the mesh."""
    affine = np.diag([VOXEL, VOXEL, VOXEL, 1.0])
    affine[:3, 3] = CORNER - 9.0
    return ImageGrid((40, 40, 40), affine)


def block_of_brain() -> TetMesh:
    """A cube in the right hemisphere, held at its bottom, with a tumour inside."""
    block = block_mesh(6, side=SIDE)
    centres = block.points[block.cells].mean(axis=1)
    tumour = (np.abs(centres - SIDE / 2) < 10.0).all(axis=1)
    return replace(block, points=block.points + CORNER, region=tumour.astype(np.int32))


def bump(points: FloatArray, size_mm: float) -> FloatArray:
    """A smooth displacement that is largest in the middle and zero at the faces."""
    x = (points - CORNER) / SIDE
    height = np.prod(np.sin(np.pi * np.clip(x, 0.0, 1.0)), axis=1)
    along: FloatArray = size_mm * height[:, None] * np.array([0.6, 0.0, -0.8])
    return along

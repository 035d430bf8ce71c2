"""Places of tissue that is not there any more."""

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.geometry.image import Image
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging.voxel_fields import rasterize

AnyImage = TypeVar("AnyImage", bound=Image)


def without_tissue(image: AnyImage, removed: TetMesh) -> AnyImage:
    """Return an image of the rest state with 0 where tissue was removed.

    Parameters
    ----------
    image : Image
        Of intensities or labels.
    removed : TetMesh
        What was removed, at rest.
    """
    nothing = np.zeros((removed.n_points, 1))
    _, cell = rasterize(removed.points, removed.cells, nothing, image.grid)
    data = np.array(image.data)
    data[cell >= 0] = 0
    return replace(image, data=data)


def points_within(removed: TetMesh, points: FloatArray) -> BoolArray:
    """Return which points (n, 3) of the rest state lie in removed tissue."""
    import pyvista as pv

    grid = pv.UnstructuredGrid({pv.CellType.TETRA: removed.cells}, removed.points)
    found: Any = grid.find_containing_cell(points)
    inside: BoolArray = np.atleast_1d(found) >= 0
    return inside

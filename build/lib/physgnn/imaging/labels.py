"""The label map of a deformed body."""

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid, LabelVolume
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging.voxel_fields import rasterize


def deformed_labels(
    mesh: TetMesh, displacement: FloatArray, grid: ImageGrid
) -> LabelVolume:
    """Return which tissue is where after the deformation.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    displacement : (n_points, 3) array
        mm; zero for the label map of the rest state.
    grid : ImageGrid
        Where to sample; a voxel has the tissue at its centre.

    Returns
    -------
    LabelVolume
        0 outside, 1 brain, 2 tumour, 3 ventricle: the region plus one.

    Raises
    ------
    InputError
        If mesh and grid do not meet.
    """
    moved = mesh.points + displacement
    _, cell = rasterize(moved, mesh.cells, np.empty((mesh.n_points, 0)), grid)
    if (cell < 0).all():
        raise InputError(
            "mesh and image do not meet: check that both are in the same world "
            "coordinates, mm"
        )
    labels = np.append(mesh.region + 1, 0).astype(np.int32)
    return LabelVolume(labels[cell], grid.affine)

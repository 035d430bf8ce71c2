"""A block inside an oblique image, and images with one bright spot."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from physgnn.arrays import FloatArray
from physgnn.geometry.image import Image, ImageGrid
from physgnn.geometry.tetmesh import TetMesh


@pytest.fixture(scope="session")
def oblique() -> ImageGrid:
    """A grid about a block of 10 mm, oblique, left-handed, with unequal voxels."""
    affine = np.eye(4)
    turn = Rotation.from_euler("zyx", [20, -10, 15], degrees=True).as_matrix()
    affine[:3, :3] = turn @ np.diag([-0.5, 0.7, 0.9])
    shape = (50, 36, 28)
    affine[:3, 3] = 5.0 - affine[:3, :3] @ (np.array(shape) - 1) / 2
    return ImageGrid(shape, affine)


def rigid(
    mesh: TetMesh, angles_deg: tuple[float, ...], shift_mm: tuple[float, ...]
) -> FloatArray:
    """The displacement of a rigid motion about the block's centre."""
    turn = Rotation.from_euler("xyz", angles_deg, degrees=True).as_matrix()
    return (mesh.points - 5.0) @ turn.T + 5.0 + shift_mm - mesh.points


def spot(grid: ImageGrid, centre: FloatArray) -> Image:
    """A Gaussian spot at a world point."""
    index = np.moveaxis(np.indices(grid.shape), 0, -1)
    distance = np.linalg.norm(grid.to_world(index) - centre, axis=-1)
    return Image(np.exp(-((distance / 1.2) ** 2)), grid.affine)


def centre_of(image: Image) -> FloatArray:
    """The world point of an image's centre of mass."""
    index = np.argwhere(image.data > 0)
    weights = np.asarray(image.data[image.data > 0], dtype=np.float64)
    centre: FloatArray = np.average(image.grid.to_world(index), axis=0, weights=weights)
    return centre

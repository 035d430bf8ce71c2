"""A block of brain, and the voxels that its scans have."""

import pytest

from brain_block import block_of_brain, voxels
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.tetmesh import TetMesh


@pytest.fixture(scope="module")
def brain() -> TetMesh:
    return block_of_brain()


@pytest.fixture(scope="module")
def grid() -> ImageGrid:
    return voxels()

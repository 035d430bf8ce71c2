"""What the tests share: the approximation of the block, made once."""

import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.meshless.approximation import Approximation, make_approximation
from physgnn.mechanics.meshless.options import DEFAULT_MESHLESS


@pytest.fixture(scope="session")
def approximation(block: TetMesh) -> Approximation:
    return make_approximation(block, DEFAULT_MESHLESS)

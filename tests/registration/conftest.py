"""A block that tests of registration share; its modes take a second."""

import pytest
from block_shifts import MATERIALS, open_box

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.registration.registrar import Registrar


@pytest.fixture(scope="session")
def body() -> TetMesh:
    """A block in a box, open at the top."""
    return open_box()


@pytest.fixture(scope="session")
def registrar(body: TetMesh) -> Registrar:
    """Ready to register it."""
    return Registrar(Body(body, MATERIALS))

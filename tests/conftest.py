"""Fixtures that more than one test module uses."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from meshes import block_mesh
from physgnn import interrupts
from physgnn.geometry.tetmesh import TetMesh
from warm_python import WarmPython

# Kernels compile on first use, so a first example may take seconds.
settings.register_profile("physgnn", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("physgnn")


# A shell starts what runs in its background such that it ignores Ctrl-C, and children
# inherit that; those that a handler is set for begin with the default.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(
    config: pytest.Config, items: list[pytest.Item]
) -> None:
    """Processes that share the tests begin with the slow ones, to end together."""
    if hasattr(config, "workerinput"):
        slow = {item.path for item in items if item.get_closest_marker("slow")}
        items.sort(key=lambda item: item.path not in slow)


@pytest.fixture(autouse=True)
def _signals() -> Iterator[None]:
    """A command called in this process leaves Ctrl-C as it was."""
    yield
    interrupts.uninstall()


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of reference data; tests that need it skip where it is absent."""
    default = Path(__file__).parents[2] / "shared"
    folder = Path(os.environ.get("PHYSGNN_SHARED", default))
    if not (folder / "paper" / "PROTOCOL.md").is_file():
        pytest.skip(f"reference data not found at {folder} (set PHYSGNN_SHARED)")
    return folder


@pytest.fixture(scope="session")
def block() -> TetMesh:
    """A jittered block of 3³ cubes."""
    return block_mesh(3, jitter=0.15)


@pytest.fixture(scope="session")
def warm() -> Iterator[WarmPython]:
    """Starts programs that train, predict and evaluate."""
    with WarmPython("physgnn.stages", "physgnn.stages.networks.training") as python:
        yield python

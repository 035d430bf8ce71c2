"""A block with a tumour on show, and a server to show it."""

from collections.abc import Iterator

import numpy as np
import pytest
from live_server import Address, serving

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.baselines.linear import Linear
from physgnn.learning.surrogate import FromFunction
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.materials import NeoHookean
from physgnn.prediction.error_bounds.calibration import Calibration
from physgnn.prediction.error_bounds.indicators import INDICATORS
from physgnn.prediction.error_bounds.trained_range import TrainedRange
from physgnn.prediction.predictor import Predictor
from physgnn.serving.scene.patch_load import Exposed
from physgnn.serving.scene.viewed import Viewed
from physgnn.serving.sessions.engine import Engine

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
WARM = 0.9  # the stand-in for a network: linear elasticity times this


@pytest.fixture(scope="session")
def body(block: TetMesh) -> Body:
    return Body(block, MATERIALS, block.point_set("fixed"))


@pytest.fixture(scope="session")
def viewed(body: Body) -> Viewed:
    """A body with a stand-in for a network, calibrated by hand."""
    top = body.mesh.point_set("loaded")
    down = np.tile([0.0, 0.0, -0.02 / len(top)], (len(top), 1))
    linear = Linear(body)
    calibration = Calibration(
        indicator="displacement",
        coverage=0.9,
        mean_factor=0.1,
        max_factor=0.2,
        n_paths=9,
        n_samples=9,
        trained_range=TrainedRange.from_cases([LoadCase(top, down)]),
    )
    warm = FromFunction(body, lambda case: WARM * linear.predict(case))
    network = Predictor(warm, calibration=calibration)
    return Viewed(
        title="block",
        body=body,
        predictors={"network": network, "linear": Predictor(linear)},
        exposed=Exposed.of(body, top),
        calibration=calibration,
        indicator=INDICATORS["displacement"](warm),
    )


@pytest.fixture
def engine(viewed: Viewed) -> Iterator[Engine]:
    engine = Engine(viewed)
    yield engine
    engine.close()


@pytest.fixture(scope="module")
def address(viewed: Viewed) -> Iterator[Address]:
    with serving(Engine(viewed)) as address:
        yield address

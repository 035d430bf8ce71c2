"""A load that holds growth: finite elements solve it, networks refuse it."""

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.mechanics import Body, LoadPath, NeoHookean, Solver, VolumeGrowth
from physgnn.prediction.finite_element import solve_by_finite_elements
from physgnn.prediction.prediction import PredictionStatus
from physgnn.stages.patient.intraoperative.prediction import _of_any_load

MESH = block_mesh(2, jitter=0.15)
BODY = Body(MESH, {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(7500.0, 0.45)})
SWELLS = LoadPath.of(np.ones(1), VolumeGrowth(np.flatnonzero(MESH.region == 1), 1.2))


def test_finite_elements_solve_it_within_the_tolerance() -> None:
    found = solve_by_finite_elements(BODY, SWELLS, tolerance_mm=1e-3)
    exact = Solver(BODY).solve(SWELLS).displacement[0]
    assert found.status == PredictionStatus.OK
    assert found.error_estimate_mm is not None
    assert found.error_estimate_mm.max_mm <= 1e-3
    np.testing.assert_allclose(found.displacement, exact, atol=1e-3)
    with pytest.raises(InputError, match="tolerance_mm must be > 0"):
        solve_by_finite_elements(BODY, SWELLS, tolerance_mm=0.0)


@pytest.mark.parametrize(("tolerance", "linear"), [(None, False), (0.1, True)])
def test_networks_refuse_it_plainly(tolerance: float | None, linear: bool) -> None:
    with pytest.raises(InputError, match=r"a\.json: networks .* --tolerance-mm"):
        _of_any_load(BODY, SWELLS, "a.json", tolerance, linear=linear)

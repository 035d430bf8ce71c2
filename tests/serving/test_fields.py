import numpy as np
import pytest

from physgnn.mechanics.loads import LoadCase
from physgnn.serving.fields import FIELDS
from physgnn.serving.viewed import Viewed


@pytest.fixture
def case(viewed: Viewed) -> LoadCase:
    return LoadCase(viewed.exposed.nodes[:4], np.tile([0, 0, -1e-3], (4, 1)))


def test_volume_ratio_is_det_f(viewed: Viewed, case: LoadCase) -> None:
    F = np.array([[1.1, 0.2, 0], [0, 0.9, 0.1], [0.3, 0, 1.05]])
    stretched = viewed.body.mesh.points @ (F - np.eye(3)).T
    ratio = FIELDS["volume"](viewed, "linear", case, stretched)
    np.testing.assert_allclose(ratio, np.linalg.det(F))


def test_the_error_field_peaks_at_the_bound(viewed: Viewed, case: LoadCase) -> None:
    prediction = viewed.answers["network"](case)
    field = FIELDS["error"](viewed, "network", case, prediction.displacement)
    assert prediction.error_estimate_mm is not None
    floor = 0.01 * viewed.calibration.max_factor  # calibration.FLOOR_MM
    assert field.max() + floor == pytest.approx(prediction.error_estimate_mm.max_mm)


def test_linear_elasticity_has_no_error_field(viewed: Viewed, case: LoadCase) -> None:
    zero = np.zeros_like(viewed.body.mesh.points)
    assert FIELDS["error"](viewed, "linear", case, zero) is None

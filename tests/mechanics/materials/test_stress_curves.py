"""A measured curve is one loading branch; what else it may be is named."""

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.materials.stress_curves import StressCurve


def test_relative_error() -> None:
    """Twice as stiff a law is off by 100 %, and in shear it is exact."""
    amount = np.array([0.0, 0.1, 0.2, 0.3])
    stiff, soft = NeoHookean(6000.0, 0.4), NeoHookean(3000.0, 0.4)
    curve = StressCurve("shear", amount, 3000.0 / 2.8 * amount)
    assert curve.relative_error(soft) < 1e-12
    assert np.isclose(curve.relative_error(stiff), 1.0, rtol=1e-12)
    assert np.array_equal(curve.strain, amount)


@pytest.mark.parametrize(
    ("kind", "amount", "stress", "message"),
    [
        ("bend", [1, 1.1, 1.2, 1.3], [0, 1, 2, 3], "kind must be one of tension"),
        ("tension", [1, 1.1, 1.2], [0, 1, 2], r"needs 3 points or more .* \(got 2\)"),
        ("tension", [1, 1.1, 1.2, 1.3], [0, 1, 2], r"its stress \(got 4 and 3\)"),
        ("tension", [1, 1.1, np.nan, 1.3], [0, 1, 2, 3], "must be finite"),
        ("shear", [0, 0.1, 0.2, 0.3], [0, 1, np.inf, 3], "must be finite"),
        ("tension", [1, 1.2, 1.1, 1.3], [0, 1, 2, 3], r"grow .*got 1.1 after 1.2"),
        ("shear", [0, 0.1, 0.1, 0.3], [0, 1, 2, 3], "give one loading branch"),
        ("compression", [1, 0.9, 0.95, 0.8], [0, -1, -2, -3], "got 0.95 after 0.9"),
        ("compression", [1, 0.9, 0.1, 0.0], [0, -1, -2, -3], r"must be > 0, 1 at rest"),
        ("tension", [0.0, 0.1, 0.2, 0.3], [0, 1, 2, 3], r"stretch must be > 0"),
        ("tension", [1, 0.9, 0.8, 0.7], [0, 1, 2, 3], r"takes stretch ≥ 1 \(got 0.9"),
        ("compression", [1, 1.1, 1.2, 1.3], [0, 1, 2, 3], "takes stretch ≤ 1"),
        ("shear", [0, -0.1, -0.2, -0.3], [0, 1, 2, 3], "amount of shear ≥ 0"),
        ("compression", [1, 0.9, 0.8, 0.7], [0, 1, 2, 3], "has the wrong sign"),
        ("shear", [0, 0.1, 0.2, 0.3], [0, 0, 0, 0], r"must be in 1e-06…1e\+09 Pa"),
        ("shear", [0, 0.1, 0.2, 0.3], [0, 1, 2, 1e300], r"1e\+300 Pa\): name its unit"),
        ("tension", [1, 5, 10, 15], [0, 1, 2, 3], "got 15, .* stretch, not percent"),
        ("compression", [1, 0.5, 0.2, 0.01], [0, -1, -2, -3], "got 0.01, and no test"),
    ],
)
def test_refusals(kind, amount, stress, message) -> None:
    with pytest.raises(InputError, match=message):
        StressCurve(kind, np.array(amount), np.array(stress))

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.measured_pairs import PointPairs


def test_displacement_is_target_minus_source() -> None:
    source = np.arange(12.0).reshape(4, 3)
    pairs = PointPairs(source, source + np.array([1, 2, 3]))
    np.testing.assert_array_equal(pairs.displacement, np.tile([1, 2, 3], (4, 1)))


@pytest.mark.parametrize(
    ("n_source", "n_target", "value"), [(3, 4, 0.0), (2, 2, 0.0), (3, 3, np.nan)]
)
def test_what_does_not_pair_is_refused(
    n_source: int, n_target: int, value: float
) -> None:
    with pytest.raises(InputError):
        PointPairs(np.full((n_source, 3), value), np.zeros((n_target, 3)))

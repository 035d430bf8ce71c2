"""What is wrong with a measurement is as wrong as it says, and nothing else is."""

import numpy as np
import pytest
from scipy.spatial.distance import pdist

from physgnn.arrays import FloatArray
from physgnn.evaluation.in_silico.measurement_errors import (
    MEASUREMENT_ERRORS,
    OFFSET_MM,
    OUTLIER_MM,
    Measured,
)
from physgnn.geometry.measured import Landmarks, PointPairs, SurfacePoints


@pytest.fixture
def measured() -> list[Measured]:
    rng = np.random.default_rng(0)
    pairs, inside = rng.uniform(0, 50, (2, 2, 40, 3))
    surface = SurfacePoints(rng.uniform(0, 50, (200, 3)))
    return [PointPairs(*pairs), Landmarks(*inside[:, :15]), surface]


def found_now(measured: list[Measured]) -> list[FloatArray]:
    """What was found after the shift."""
    return [o.target if isinstance(o, PointPairs) else o.points for o in measured]


def spoilt(name: str, measured: list[Measured]) -> list[Measured]:
    found = MEASUREMENT_ERRORS[name](measured, np.random.default_rng(1))
    assert [type(one) for one in found] == [type(one) for one in measured]
    for one, before in zip(found, measured, strict=True):
        if isinstance(one, PointPairs) and isinstance(before, PointPairs):
            np.testing.assert_array_equal(one.source, before.source)
    return found


def test_a_tenth_are_outliers_of_the_stated_length(measured: list[Measured]) -> None:
    after = found_now(spoilt("outliers", measured))
    for one, before, count in zip(after, found_now(measured), (4, 2, 20), strict=True):
        away = np.linalg.norm(one - before, axis=1)
        np.testing.assert_allclose(away[away > 0], OUTLIER_MM)
        assert (away > 0).sum() == count


def test_two_pairs_are_swapped_and_surfaces_have_none(measured: list[Measured]) -> None:
    after, before = found_now(spoilt("swapped", measured)), found_now(measured)
    for one, as_was in zip(after[:2], before[:2], strict=True):
        i, j = np.flatnonzero((one != as_was).any(axis=1))
        np.testing.assert_array_equal(one[[i, j]], as_was[[j, i]])
    np.testing.assert_array_equal(after[2], before[2])


def test_an_offset_moves_all_as_one_body(measured: list[Measured]) -> None:
    after = np.concatenate(found_now(spoilt("offset", measured)))
    before = np.concatenate(found_now(measured))
    np.testing.assert_allclose(pdist(after), pdist(before))
    middle = after.mean(axis=0) - before.mean(axis=0)
    np.testing.assert_allclose(np.linalg.norm(middle), OFFSET_MM)

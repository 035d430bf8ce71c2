import numpy as np
import pytest
from scipy.stats import chi2, norm

from physgnn.errors import InputError
from physgnn.prediction.wrong_position import isotropic, probability_beyond


def covariances(n: int, seed: int = 0) -> np.ndarray:
    """Random ones, from nearly isotropic to nearly flat and nearly lines."""
    random = np.random.default_rng(seed)
    turn = np.linalg.qr(random.normal(size=(n, 3, 3)))[0]
    deviations = 10.0 ** random.uniform(-2.0, 0.9, size=(n, 3))
    return (turn * deviations[:, None, :] ** 2) @ np.swapaxes(turn, 1, 2)


@pytest.mark.parametrize("t", [0.5, 2.0, 5.0])
def test_against_sampling(t: float) -> None:
    C = covariances(40)
    found = probability_beyond(C, t)
    random = np.random.default_rng(1)
    n = 200_000
    for matrix, chance in zip(C, found, strict=True):
        errors = random.standard_normal((n, 3)) @ np.linalg.cholesky(matrix).T
        share = (np.linalg.norm(errors, axis=1) > t).mean()
        allowed = 5 * np.sqrt(max(chance * (1 - chance), 1 / n) / n)
        assert abs(share - chance) < allowed


def test_closed_forms() -> None:
    """A ball, a disc, a line, a point: chi-square of 3, 2, 1 and 0 degrees."""
    sizes = np.array([0.3, 1.0, 2.0, 8.0])
    for rank in (1, 2, 3):
        C = np.zeros((4, 3, 3))
        for axis in range(rank):
            C[:, axis, axis] = sizes**2
        wanted = chi2.sf(4.0 / sizes**2, rank)
        np.testing.assert_allclose(probability_beyond(C, 2.0), wanted, atol=1e-6)
        if rank == 1:
            np.testing.assert_allclose(wanted, 2 * norm.sf(2.0 / sizes))
    assert probability_beyond(np.zeros((1, 3, 3)), 2.0) == [0.0]


def test_isotropic_errors_have_the_deviation_for_their_root_trace() -> None:
    C = isotropic(np.array([3.0]))
    assert np.trace(C[0]) == pytest.approx(9.0)
    np.testing.assert_allclose(probability_beyond(C, 3.0), chi2.sf(3.0, 3), atol=1e-9)


@pytest.mark.parametrize("t", [0.0, -1.0, np.nan, np.inf])
def test_a_threshold_must_be_a_length(t: float) -> None:
    with pytest.raises(InputError, match="must be > 0"):
        probability_beyond(np.eye(3)[None], t)


def test_what_is_no_covariance_is_refused() -> None:
    with pytest.raises(InputError, match="no covariance at point 1"):
        probability_beyond(np.stack([np.eye(3), np.diag([1.0, 1.0, -0.5])]), 2.0)
    with pytest.raises(InputError, match=r"finite, \(n, 3, 3\)"):
        probability_beyond(np.full((1, 3, 3), np.nan), 2.0)

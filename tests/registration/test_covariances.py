import numpy as np

from physgnn.registration.covariances import point_covariance


def test_it_is_the_covariance_of_drawn_errors_scaled_to_the_deviation() -> None:
    random = np.random.default_rng(0)
    A = random.normal(size=(5, 5))
    C, response = A @ A.T, random.normal(size=(5, 7, 3)).astype(np.float32)
    draws = random.multivariate_normal(np.zeros(5), C, size=100_000)
    errors = np.tensordot(draws, response, 1)
    drawn = np.einsum("kni,knj->nij", errors, errors) / len(draws)
    deviation = 2.0 * np.sqrt(np.trace(drawn, axis1=1, axis2=2))
    found = point_covariance(C, response, deviation)
    np.testing.assert_allclose(found, 4.0 * drawn, atol=0.03 * found.max())
    traces = np.trace(found, axis1=1, axis2=2)
    np.testing.assert_allclose(np.sqrt(traces), deviation)


def test_a_point_that_no_mode_moves_has_none() -> None:
    response = np.zeros((2, 3, 3), np.float32)
    assert (point_covariance(np.eye(2), response, np.zeros(3)) == 0).all()

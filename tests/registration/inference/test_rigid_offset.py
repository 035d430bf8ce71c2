"""An offset where there is one, none where there is none, and how far it is known."""

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.spatial.transform import Rotation
from scipy.stats import multivariate_normal

from physgnn.registration.inference.gaussian import log_evidence
from physgnn.registration.inference.rigid_offset import (
    HYPOTHESES,
    MISPLACED,
    compared,
    unknown_of,
)
from physgnn.registration.inference.rows import MeasuredRows, Modes, rigid_columns
from physgnn.registration.measurements.observation import Observation


class Places:
    """Only what the columns need of a measurement."""

    def __init__(self, measured: np.ndarray) -> None:
        self.measured = measured


def seen_along(axes: np.ndarray) -> Observation:
    n = len(axes)
    return Observation(csr_array(np.eye(n)), axes, np.zeros(axes.shape[:2]))


def test_columns_are_the_derivative_of_a_rigid_motion() -> None:
    rng = np.random.default_rng(0)
    points = 50 * rng.normal(size=(12, 3))
    normals = rng.normal(size=(12, 1, 3))
    t, turn = 1e-3 * rng.normal(size=3), 1e-5 * rng.normal(size=3)
    parts = [np.tile(np.eye(3), (12, 1, 1)), normals]
    columns, centre = rigid_columns(
        [seen_along(axes) for axes in parts],
        [Places(points), Places(points)],  # type: ignore[list-item]
    )
    rotated = Rotation.from_rotvec(turn).apply(points - centre)
    moved = centre + rotated + t - points
    wanted = [np.einsum("nki,ni->nk", axes, moved).ravel() for axes in parts]
    found = columns @ np.concatenate([t, turn])
    np.testing.assert_allclose(found, np.concatenate(wanted), atol=1e-7)


def test_evidence_is_the_density_of_the_data() -> None:
    rng = np.random.default_rng(0)
    A, d, prior = rng.normal(size=(7, 3)), rng.normal(size=7), np.array([1.0, 2.0, 0.5])
    C = A @ np.diag(prior) @ A.T + 0.3**2 * np.eye(7)
    wanted = multivariate_normal(np.zeros(7), C).logpdf(d)
    assert log_evidence(A, d, prior, 0.3) == pytest.approx(wanted)


@pytest.mark.parametrize("size", [0.0, 5.0])
def test_an_offset_is_found_only_where_there_is_one(size: float) -> None:
    """Loads that move half of the places cannot move all of them alike."""
    rng = np.random.default_rng(3)
    points = 30 * rng.normal(size=(40, 3))
    columns, _ = rigid_columns(
        [seen_along(np.tile(np.eye(3), (40, 1, 1)))],
        [Places(points)],  # type: ignore[list-item]
    )
    A = np.zeros((40, 3, 4))
    A[:20] = rng.normal(size=(20, 3, 4))
    A = A.reshape(120, 4)
    t = size * np.array([0.6, 0.0, 0.8])
    d = A @ [3.0, -2.0, 1.0, 2.0] + columns[:, :3] @ t + 0.5 * rng.normal(size=120)
    rows = MeasuredRows(A / 0.5, d / 0.5, np.full(120, 0.5), ((40, 3),)).with_columns(
        columns
    )
    modes = Modes(np.zeros(4, dtype=np.int64), np.empty(0), 0.5)
    comparison = compared(rows, modes, np.ones(40))
    assert comparison.probabilities.sum() == pytest.approx(1.0)
    assert len(comparison.fits) == len(HYPOTHESES)
    with_offset = comparison.likely
    found = with_offset.posterior.mean[-6:-3]
    np.testing.assert_allclose(found, t, atol=0.4)
    assert (comparison.log_ratio > 3.0) == (size > 0)
    assert (comparison.probabilities[0] < 0.05) == (size > 0)
    deviation = np.sqrt(with_offset.posterior.covariance.diagonal()[-6:-3])
    assert (deviation < 0.3).all()


def test_what_a_load_can_imitate_of_an_offset_stays_unknown() -> None:
    """A load that moves every place along z as a tracker would, of 3 mm beforehand."""
    rng = np.random.default_rng(4)
    points = 30 * rng.normal(size=(500, 3))
    columns, _ = rigid_columns(
        [seen_along(np.tile(np.eye(3), (500, 1, 1)))],
        [Places(points)],  # type: ignore[list-item]
    )
    alike, held = columns[:, 2:3], np.zeros((1500, 1))
    noise = np.full(1500, 0.5)
    offset = MISPLACED.translation_mm
    for load, wanted in (
        (alike, offset * 3 / np.hypot(offset, 3)),
        (held, 0.5 / 500**0.5),
    ):
        rows = MeasuredRows(load / 0.5, np.zeros(1500), noise, ((500, 3),))
        told = unknown_of(rows.with_columns(columns), np.array([9.0]), np.ones(500))
        assert told == pytest.approx(wanted, rel=0.01)

"""Shifts of a block in a box, open at the top, where it is measured."""

import numpy as np
import pytest
from block_shifts import (
    MATERIALS,
    NOISE,
    SIDE,
    errors,
    measured,
    seen_surface,
    true_shift,
)

from physgnn.errors import InputError
from physgnn.geometry.measured import PointPairs, SurfacePoints
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import (
    LoadPath,
    RestState,
    Solver,
    deformation_gradient,
)
from physgnn.mechanics.body import Body
from physgnn.prediction import PredictionStatus
from physgnn.registration.load_families import load_modes
from physgnn.registration.registrar import Registrar


@pytest.mark.parametrize("seed", range(4))
def test_whole_field_follows_from_the_top(
    seed: int, body: TetMesh, registrar: Registrar
) -> None:
    u = true_shift(body, seed, 12.0)
    found = registrar(measured(body, u, seed), noise_mm=NOISE)
    assert found.prediction.status == PredictionStatus.OK
    error = errors(found, u)
    assert error.mean() < 0.3 * np.linalg.norm(u, axis=1).mean()
    # averaging over points beats the noise of one of them, √3 · 0.7 mm
    assert error[body.point_set("loaded")].mean() < 0.8
    assert (found.prediction.displacement[body.point_set("fixed")] == 0).all()
    F = deformation_gradient(body, found.prediction.displacement)
    assert np.linalg.det(F).min() > 0
    assert 0.6 * np.sqrt(3) * NOISE < found.misfit_mm < found.held_out_mm < 2.0
    estimate = found.prediction.error_estimate_mm
    assert estimate is not None
    assert 0.05 < estimate.mean_mm < 2.0
    assert estimate.mean_mm <= estimate.max_mm
    top = body.point_set("loaded")
    assert found.deviation_mm[top].max() < found.deviation_mm.max()


def test_large_shifts_need_the_nonlinear_steps(
    body: TetMesh, registrar: Registrar
) -> None:
    u = true_shift(body, 1, 18.0)
    pairs = measured(body, u, 1)
    linear = registrar(pairs, noise_mm=NOISE, linear=True)
    nonlinear = registrar(pairs, noise_mm=NOISE)
    assert errors(nonlinear, u).mean() < errors(linear, u).mean()


def test_the_answer_is_the_equilibrium_of_its_forces(
    body: TetMesh, registrar: Registrar
) -> None:
    u = true_shift(body, 0, 10.0)
    found = registrar(measured(body, u, 0), noise_mm=NOISE)
    loaded = np.setdiff1d(np.arange(body.n_points), body.point_set("fixed"))
    path = LoadPath(loaded, found.forces[loaded], np.ones(1))
    again = Solver(Body(body, MATERIALS)).solve(path).displacement[0]
    np.testing.assert_allclose(again, found.prediction.displacement, atol=0.02)


def test_small_noiseless_shifts_are_found_within_microns(
    body: TetMesh, registrar: Registrar
) -> None:
    w = np.zeros(len(registrar.modes.family))
    w[[0, 2]] = 0.01, -0.02
    u = np.tensordot(w, registrar.modes.response, 1)
    top = body.point_set("loaded")
    pairs = PointPairs(body.points[top], body.points[top] + u[top])
    found = registrar(pairs, noise_mm=1e-4, linear=True)
    assert errors(found, u).max() < 0.005


def test_a_surface_without_correspondence_tells_of_the_depth(
    body: TetMesh, registrar: Registrar
) -> None:
    u = true_shift(body, 2, 12.0)
    found = registrar(seen_surface(body, u, 2), noise_mm=NOISE)
    assert found.prediction.status == PredictionStatus.OK_IF_NAVIGATION_IS_RIGHT
    error, size = errors(found, u), np.linalg.norm(u, axis=1)
    assert error.mean() < 0.4 * size.mean()
    # across the surface half a noise is left, and it is what the misfit measures
    top = body.point_set("loaded")
    lag = (found.prediction.displacement - u)[top]
    assert np.abs(lag[:, 2]).mean() < NOISE
    assert found.misfit_mm == pytest.approx(NOISE, rel=0.25)
    # what slides within it is not seen, and the bound says so
    estimate = found.prediction.error_estimate_mm
    assert estimate is not None
    assert error.mean() < estimate.mean_mm and error.max() < estimate.max_mm


def test_a_skull_that_lets_slide_is_found_by_the_registration_that_knows(
    body: TetMesh, registrar: Registrar
) -> None:
    sliding = Registrar(Body(body, MATERIALS), skull="sliding")
    walls = body.point_set("fixed")
    force = np.zeros_like(body.points)
    force[body.point_set("loaded")] = [0.16, 0.0, -0.16]
    u = np.zeros_like(body.points)
    for _ in range(12):
        response, back = sliding.tangent(u, force[None].astype(np.float32))
        u = u + response[0] + back
    assert np.linalg.norm(u[walls], axis=1).max() > 1.0
    pairs = measured(body, u, 0)
    knows, assumes = sliding(pairs, noise_mm=NOISE), registrar(pairs, noise_mm=NOISE)
    assert errors(knows, u).mean() < 0.85 * errors(assumes, u).mean()
    assert errors(knows, u)[walls].mean() < 0.6 * errors(assumes, u)[walls].mean()
    # the floor keeps its height and the walls their planes
    moved = knows.prediction.displacement
    x, y, z = body.points.T
    inner = (x > 0) & (x < SIDE) & (y > 0) & (y < SIDE)
    assert np.abs(moved[inner & (z == 0), 2]).max() < 0.05
    assert np.linalg.norm(moved[inner & (z == 0), :2], axis=1).max() > 0.1


@pytest.mark.parametrize(
    ("spoil", "status"),
    [
        (lambda p: PointPairs(p.source[[0] * 10], p.target[[0] * 10]), "TOO_FEW"),
        (lambda p: PointPairs(p.source[:3], p.target[:3]), "TOO_FEW"),
        (lambda p: PointPairs(p.source, p.source + np.array([8.0, 0, 0])), "MOVED_AS"),
        (lambda p: PointPairs(p.source, p.source + 8 * (p.target - p.source)), ""),
        (lambda p: PointPairs(p.source, np.roll(p.target, 2, axis=0)), ""),
    ],
)
def test_a_measurement_that_tells_nothing_is_not_ok(
    spoil, status: str, body: TetMesh, registrar: Registrar
) -> None:
    pairs = spoil(measured(body, true_shift(body, 0, 10.0), 0))
    found = registrar(pairs, noise_mm=NOISE).prediction
    assert not found.status.usable
    assert found.status.name.startswith(status)
    assert found.reasons


def test_a_surface_far_from_the_body_is_not_ok(
    body: TetMesh, registrar: Registrar
) -> None:
    seen = seen_surface(body, np.zeros_like(body.points), 0)
    away = SurfacePoints(seen.points + np.array([0, 0, 15.0]))
    found = registrar(away, noise_mm=NOISE).prediction
    assert found.status == PredictionStatus.MEASUREMENT_TOO_FAR


def test_a_noise_stated_far_too_small_is_told_by_the_misfit(
    body: TetMesh, registrar: Registrar
) -> None:
    pairs = measured(body, true_shift(body, 0, 10.0), 0)
    found = registrar(pairs, noise_mm=NOISE / 10).prediction
    assert not found.status.usable
    assert any("stated noise" in reason for reason in found.reasons)


def test_wrong_numbers_are_refused(body: TetMesh, registrar: Registrar) -> None:
    pairs = measured(body, np.zeros_like(body.points), 0)
    for options in ({"noise_mm": 0.0}, {"noise_mm": np.nan}, {"coverage": 1.0}):
        (name,) = options
        with pytest.raises(InputError, match=name):
            registrar(pairs, **options)
    with pytest.raises(InputError, match="skull must be one of fixed, sliding"):
        Registrar(Body(body, MATERIALS), skull="loose")
    far = SurfacePoints(np.random.default_rng(0).normal(size=(20, 3)) + 400.0)
    with pytest.raises(InputError, match="from the brain's surface"):
        registrar(far)


def test_modes_are_scaled_and_their_responses_linear_elasticity(body: TetMesh) -> None:
    whole = Body(body, MATERIALS)
    rest = RestState(whole)
    modes = load_modes(
        body, body.point_set("fixed"), rest.solve, elements=whole.elements, causes=()
    )
    pick = slice(None, None, 40)
    again = rest.solve(modes.forces[pick].astype(np.float64))
    np.testing.assert_allclose(again, modes.response[pick], atol=1e-5)
    assert set(modes.family) == {0, 1, 2} and len(modes.names) == 3
    total = modes.forces[modes.family == 0].sum(axis=1)
    np.testing.assert_allclose(total, np.diag(total.diagonal()), atol=1e-6)


@pytest.mark.parametrize("factor", [0.001, 0.1])
@pytest.mark.parametrize("kind", ["pairs", "surface"])
def test_another_unit_is_refused(
    registrar: Registrar, body: TetMesh, kind: str, factor: float
) -> None:
    """In metres, 30 mm of misfit and nothing moved came of it."""
    top = body.points[body.point_set("loaded")] * factor
    given = PointPairs(top, top) if kind == "pairs" else SurfacePoints(top)
    with pytest.raises(InputError, match="must be in mm"):
        registrar(given)


def test_one_end_of_pairs_in_another_unit_is_named(
    registrar: Registrar, body: TetMesh
) -> None:
    """It was a large displacement."""
    top = body.points[body.point_set("loaded")]
    for ends, end in (((top / 10, top), "before"), ((top, top / 10), "after")):
        with pytest.raises(InputError, match=rf"\({end}\).*multiply them by 10"):
            registrar(PointPairs(*ends))

"""Shape functions: what they reproduce, their gradients, and points in a plane."""

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.meshless.integration import integration_places
from physgnn.mechanics.meshless.moving_least_squares import shape_functions
from physgnn.mechanics.meshless.supports import neighbours, spacing, support_radii

LEAST = 20


def evaluate(
    mesh: TetMesh, places: np.ndarray, radii: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Shape functions and gradients as full arrays, a row a place."""
    near = neighbours(mesh.points, radii, places)
    values, gradients = shape_functions(mesh.points, radii, places, near)
    place = np.repeat(np.arange(len(places)), np.diff(near.start))
    full = np.zeros((len(places), mesh.n_points))
    full[place, near.nodes] = values
    slopes = np.zeros((*full.shape, 3))
    slopes[place, near.nodes] = gradients
    return full, slopes


@pytest.fixture(scope="module")
def places(block: TetMesh) -> np.ndarray:
    return np.concatenate([integration_places(block, 4)[::7], block.points])


@pytest.fixture(scope="module")
def radii(block: TetMesh, places: np.ndarray) -> np.ndarray:
    return support_radii(
        block.points, places, wanted=np.full(len(places), 5.0), least=LEAST
    )


def test_linear_fields_are_reproduced(block, places, radii) -> None:
    values, gradients = evaluate(block, places, radii)
    np.testing.assert_allclose(values.sum(axis=1), 1, atol=1e-10)
    np.testing.assert_allclose(gradients.sum(axis=1), 0, atol=1e-10)
    np.testing.assert_allclose(values @ block.points, places, atol=1e-9)
    identity = np.einsum("qjk,ji->qik", gradients, block.points)
    np.testing.assert_allclose(
        identity, np.broadcast_to(np.eye(3), identity.shape), atol=1e-9
    )


def test_quadratic_fields_are_reproduced_to_the_penalty(block, places, radii) -> None:
    Q = np.random.default_rng(0).uniform(-1, 1, (3, 3))
    Q = Q + Q.T
    at_points = np.einsum("ji,ik,jk->j", block.points, Q, block.points)
    at_places = np.einsum("qi,ik,qk->q", places, Q, places)
    values, gradients = evaluate(block, places, radii)
    np.testing.assert_allclose(values @ at_points, at_places, atol=1e-3)
    slope = np.einsum("qjk,j->qk", gradients, at_points)
    np.testing.assert_allclose(slope, 2 * places @ Q, atol=1e-3)


def test_gradients_are_derivatives(block, places, radii) -> None:
    h = 1e-5
    _, gradients = evaluate(block, places[:40], radii[:40])
    for k in range(3):
        ahead, behind = (
            evaluate(block, places[:40] + s * h * np.eye(3)[k], radii[:40])[0]
            for s in (1, -1)
        )
        difference = (ahead - behind) / (2 * h)
        np.testing.assert_allclose(gradients[:, :, k], difference, atol=1e-6)


def test_every_place_has_enough_neighbours(block, places) -> None:
    none = np.zeros(len(places))
    radii = support_radii(block.points, places, wanted=none, least=LEAST)
    near = neighbours(block.points, radii, places)
    assert np.diff(near.start).min() >= LEAST
    distance = np.linalg.norm(places[3] - block.points, axis=1)
    mine = near.nodes[near.start[3] : near.start[4]]
    assert mine.tolist() == np.flatnonzero(distance <= radii[3]).tolist()
    wide = support_radii(block.points, places, wanted=none + 30.0, least=LEAST)
    assert (wide == 30.0).all()


def test_spacing_is_the_mean_edge() -> None:
    one = TetMesh(np.eye(4, 3, k=-1), [[0, 1, 2, 3]], [0])
    others = (1 + 2 * 2**0.5) / 3
    np.testing.assert_allclose(spacing(one), [1, others, others, others])


def test_points_in_a_plane_say_what_to_do(block) -> None:
    flat = block.points * [1.0, 1.0, 0.0]
    radii = np.full(1, 50.0)
    near = neighbours(flat, radii, flat[:1])
    with pytest.raises(InputError, match=r"lie in one plane.*refine the mesh"):
        shape_functions(flat, radii, flat[:1], near)

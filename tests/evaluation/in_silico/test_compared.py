"""What the peers of a registration are given, and where errors are counted."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from brain_block import CORNER, SIDE, block_of_brain
from physgnn.evaluation.in_silico.compared import Compared, rigid_motion
from physgnn.evaluation.in_silico.operations import MovedBrain
from physgnn.geometry.measured import Landmarks, PointPairs, SurfacePoints
from physgnn.registration.removed_region import resected

STEP = np.array([1.0, -2.0, 0.5])


@pytest.fixture
def body() -> Any:
    """What pairs and rigid motions need of a body."""
    exposed = np.random.default_rng(0).uniform(0, 50, (500, 3))
    fake = SimpleNamespace(exposed=exposed, x=exposed[:7] + 1.0)
    fake.pairs = lambda measured: Compared.pairs(fake, measured)
    return fake


def test_pairs_and_landmarks_are_taken_before_a_surface(body: Any) -> None:
    pairs = PointPairs(body.exposed[:9], body.exposed[:9] + STEP)
    inside = Landmarks(body.exposed[9:14], body.exposed[9:14] + STEP)
    elsewhere = SurfacePoints(body.exposed[20:] + 40.0)
    found = body.pairs([elsewhere, pairs, inside])
    np.testing.assert_array_equal(found.source, body.exposed[:14])
    np.testing.assert_array_equal(found.target, body.exposed[:14] + STEP)
    moved = rigid_motion(body, [pairs, elsewhere, inside])
    np.testing.assert_allclose(moved, np.tile(STEP, (7, 1)), atol=1e-9)


def test_a_surface_alone_has_the_nearest_points(body: Any) -> None:
    surface = SurfacePoints(body.exposed[:40] + 1e-3)
    for given in (surface, [surface]):
        found = body.pairs(given)
        order = np.lexsort(found.source.T), np.lexsort(body.exposed[:40].T)
        np.testing.assert_array_equal(found.source[order[0]], body.exposed[order[1]])


def test_errors_are_counted_at_the_rim_of_what_was_resected() -> None:
    whole = block_of_brain()
    rest = resected(whole, "tumour").remaining
    top: Any = CORNER + np.array([SIDE / 2, SIDE / 2, SIDE])
    before, after = (MovedBrain(m, SimpleNamespace(), top).areas for m in (whole, rest))  # type: ignore[arg-type]
    middle = CORNER + SIDE / 2
    for mesh, areas, count in ((whole, before, 3**3), (rest, after, 3**3 - 1)):
        off = np.abs(mesh.points[areas["tumour"]] - middle).max(axis=1)
        assert len(off) == count and off.max() <= 10.0 + 1e-9
        assert areas["brain"].all()
        away = np.linalg.norm(mesh.points[areas["near"]] - top, axis=1)
        assert away.max() < 50.0 and areas["near"].sum() < mesh.n_points

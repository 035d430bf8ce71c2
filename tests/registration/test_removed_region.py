"""A tumour that was taken out leaves a wall, and landmarks of it are named."""

import numpy as np
import pytest

from meshes import BOX_MM, brain_in_a_box
from physgnn.errors import InputError
from physgnn.geometry.measured import Landmarks, PointPairs, SurfacePoints
from physgnn.geometry.tetmesh import TetMesh
from physgnn.registration.removed_region import resected


@pytest.fixture(scope="module")
def brain() -> TetMesh:
    return brain_in_a_box()


def test_the_wall_is_a_set_and_what_is_gone_is_kept(brain: TetMesh) -> None:
    found = resected(brain, "tumour")
    assert (found.remaining.region == 0).all() and (found.removed.region == 1).all()
    volume = found.remaining.cell_volumes.sum() + found.removed.cell_volumes.sum()
    assert volume == pytest.approx(BOX_MM**3)
    wall = found.remaining.points[found.remaining.point_set("cavity")]
    assert (np.abs(wall - [30, 30, 40]).max(axis=1) == 10).all()
    with pytest.raises(InputError, match=r"brain, tumour \(got 'ventricle'\)"):
        resected(brain, "ventricle")


def test_the_brain_itself_is_not_removed(brain: TetMesh) -> None:
    for name in ("brain", "0"):
        with pytest.raises(InputError, match="must name a part of the brain"):
            resected(brain, name)


def test_landmarks_of_removed_tissue_are_named(brain: TetMesh) -> None:
    found = resected(brain, "tumour")
    places = np.array([[30.0, 30, 42], [30, 30, 20], [30, 30, 49.5], [10, 10, 10]])
    names = ("core", "below", "rim", "corner")
    with pytest.raises(InputError) as refused:
        found.check_measured([Landmarks(places, places, names)])
    assert "landmarks in the tumour" in str(refused.value)
    assert "'core' (8.0 mm from the wall)" in str(refused.value)
    assert not any(name in str(refused.value) for name in ("below", "rim", "corner"))
    found.check_measured([Landmarks(places[1:], places[1:])])
    found.check_measured([SurfacePoints(np.tile(places, (3, 1)))])
    with pytest.raises(InputError, match="points in the tumour"):
        found.check_measured([PointPairs(places, places)])

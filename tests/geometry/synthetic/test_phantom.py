import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry import (
    Nearest,
    Phantom,
    check_surface,
    contains,
    edge_lengths,
    mni152_phantom,
    select,
    volume,
)


@pytest.fixture(scope="module")
def phantom() -> Phantom:
    return mni152_phantom()


def test_brain_is_a_uniform_closed_surface_of_an_adult_brain(phantom: Phantom) -> None:
    brain = phantom.brain
    assert check_surface(brain, "brain")[1] == []
    assert brain.n_points == pytest.approx(700, rel=0.03)
    assert 1.5e6 < volume(brain) < 2.1e6  # the template is an average: it is large
    lengths = edge_lengths(brain)
    assert lengths.max() / lengths.min() < 4.0
    # RAS+ mm about the anterior commissure: longer than wide, wider than high
    extent = np.ptp(brain.points, axis=0)
    assert extent[1] > extent[2] > 130 and extent[1] > extent[0] > 130
    assert abs(brain.points[:, 0].mean()) < 3.0


def test_tumour_lies_under_the_cortex_with_room(phantom: Phantom) -> None:
    (tumour,) = phantom.tumours
    radii = np.linalg.norm(tumour.points - phantom.tumour_centre, axis=1)
    np.testing.assert_allclose(radii, 11.0, rtol=1e-5)
    assert 3.0 < edge_lengths(tumour).mean() < 4.0
    assert contains(phantom.brain, phantom.tumour_centre)
    gap = np.linalg.norm(tumour.points[:, None] - phantom.brain.points[None], axis=2)
    assert gap.min() > 4.0


def test_craniotomy_is_the_cortex_above_the_tumour(phantom: Phantom) -> None:
    assert (phantom.brain.points == phantom.craniotomy_point).all(axis=1).any()
    depth = np.linalg.norm(phantom.craniotomy_point - phantom.tumour_centre)
    assert depth == pytest.approx(17.0)
    rule = Nearest(tuple(phantom.craniotomy_point), 60)
    patch = phantom.brain.points[select(phantom.brain, rule)]
    assert (np.linalg.norm(patch - phantom.craniotomy_point, axis=1) < 50.0).all()


def test_same_arguments_same_case(phantom: Phantom) -> None:
    again = mni152_phantom()
    np.testing.assert_array_equal(again.brain.points, phantom.brain.points)
    np.testing.assert_array_equal(again.brain.faces, phantom.brain.faces)
    np.testing.assert_array_equal(again.tumours[0].points, phantom.tumours[0].points)


@pytest.mark.parametrize(
    "options", [{"n_points": 10}, {"tumour_radius_mm": 50.0}, {"depth_mm": 0.0}]
)
def test_refuses_arguments_out_of_range(options) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=f"{next(iter(options))} must be in"):
        mni152_phantom(**options)

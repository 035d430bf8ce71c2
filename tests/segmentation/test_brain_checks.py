"""What a network takes for a brain is one by its size, shape and tissue."""

import numpy as np
import pytest
from scipy import ndimage

from heads import head, template
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.segmentation import SegmentOptions, segment
from physgnn.segmentation.brain_checks import check_brain

MM = 2.0
X = (np.indices((100, 110, 90)) - np.reshape([50, 55, 45], (3, 1, 1, 1))) * MM
BALL = (X**2 / np.reshape([70.0, 85.0, 65.0], (3, 1, 1, 1)) ** 2).sum(axis=0) < 1.0
NOISE = np.random.default_rng(0).normal(0.0, 1.0, BALL.shape)
FOLDED = 100.0 + 200.0 * ndimage.gaussian_filter(NOISE, 1.5)


def image(values: np.ndarray) -> Image:
    return Image(values.astype(np.float32), np.diag([MM, MM, MM, 1.0]))


@pytest.mark.parametrize("gain", [1.0, 1e-3, 4000.0])
def test_brain_passes_in_any_units(gain: float) -> None:
    scan, inside = template()
    check_brain(Image(np.asarray(scan.data) * gain, scan.affine), inside)
    check_brain(image(FOLDED), BALL)


@pytest.mark.parametrize(
    "values",
    [
        200.0 + X[0] + 0.5 * X[1],
        100.0 + 5.0 * NOISE,
        np.where(BALL, 142.0, 0.0),
        # brain in CT from -1000 to 1000 Hounsfield units, taken to 0 to 255
        (1000.0 + 34.0 + 5.0 * np.sign(ndimage.gaussian_filter(NOISE, 1.5))) * 0.1275,
    ],
    ids=["ramp", "phantom", "even", "ct"],
)
def test_what_has_no_folds_is_refused(values: np.ndarray) -> None:
    with pytest.raises(InputError, match="grey and white matter"):
        check_brain(image(values), BALL)


def ct_in_the_window_of_the_brain() -> tuple[Image, np.ndarray]:
    """Tissue of 20 to 50 Hounsfield units, noise, a skull; 0 to 80 taken to 0 to 255.

    A skull is 6.5 mm thick on average (Lillie et al. 2016), the fluid below it thin.
    """
    away = ndimage.distance_transform_edt(~BALL) * MM
    tissue = 35.0 + 12.0 * ndimage.gaussian_filter(NOISE, 1.5) / 0.15
    units = np.where(BALL, tissue, np.where(away <= 2.0, 10.0, -1000.0))
    units[(away > 2.0) & (away <= 8.5)] = 900.0
    units[(away > 8.5) & (away <= 14.0)] = 40.0
    return image(np.clip(units + 3.0 * NOISE, 0.0, 80.0) * 255.0 / 80.0), BALL


def test_skull_that_is_bright_is_of_a_ct_and_refused() -> None:
    scan, inside = ct_in_the_window_of_the_brain()
    with pytest.raises(
        InputError, match=r"highest value; it looks like a CT.*any-size"
    ):
        check_brain(scan, inside)


def test_skull_that_is_dark_is_of_mr_even_where_fat_is_the_brightest() -> None:
    scan, inside = head()
    check_brain(scan, inside)
    data = np.asarray(scan.data)
    clipped = np.clip(data, None, np.percentile(data, 98.0))  # as many scans are
    check_brain(Image(clipped, scan.affine), inside)


def test_shape_is_looked_at() -> None:
    whole = np.ones_like(BALL)
    with pytest.raises(InputError, match="faces of the image"):
        check_brain(image(FOLDED), whole)
    large = np.diag([3.0, 3.0, 3.0, 1.0])
    with pytest.raises(InputError, match="75 to 230 mm"):
        check_brain(Image(FOLDED, large), BALL)
    arms = np.zeros_like(BALL)
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        arms |= (np.abs(X[others]) < 20.0).all(axis=0) & (np.abs(X[axis]) < 84.0)
    with pytest.raises(InputError, match="must be round"):
        check_brain(image(FOLDED), arms)


def test_ramp_in_the_shape_of_a_brain_is_refused_unless_it_is_meant() -> None:
    ramp = image(np.where(BALL, 200.0 + X[0], 0.0))
    with pytest.raises(InputError, match="a phantom, a ramp or a CT"):
        segment(ramp, SegmentOptions(ventricles=False))
    found = segment(ramp, SegmentOptions(ventricles=False, any_size=True))
    assert (found.data != 0).sum() > 0.9 * BALL.sum()

"""Simulated scans show tissue where it lies, and none where it was removed."""

from dataclasses import replace

import numpy as np
import pytest

from brain_block import CORNER, SIDE, VOXEL
from physgnn.evaluation.in_silico.simulated_images import (
    INTRAOPERATIVE,
    PREOPERATIVE,
    Scan,
    simulated_scan,
)
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.resection import remove_region

PLAIN = replace(PREOPERATIVE, bias=0.0, noise=0.0)


@pytest.fixture(scope="module")
def still(brain: TetMesh, grid: ImageGrid) -> Scan:
    return simulated_scan(brain, np.zeros_like(brain.points), grid, PLAIN)


def away(grid: ImageGrid) -> np.ndarray:
    """The largest coordinate of each voxel from the middle of the block, mm."""
    index = np.moveaxis(np.indices(grid.shape), 0, -1)
    middle = CORNER + SIDE / 2
    return (
        np.abs(grid.to_world(index.reshape(-1, 3)) - middle)
        .max(axis=1)
        .reshape(grid.shape)
    )


def test_every_tissue_has_its_grey_value(still: Scan, grid: ImageGrid) -> None:
    image, off = np.asarray(still.image.data), away(grid)
    np.testing.assert_array_equal(np.asarray(still.brain.data) > 0, off < SIDE / 2)
    assert (image[off > SIDE / 2] == 0).all()
    np.testing.assert_allclose(image[off < 10.0], PLAIN.tumour, rtol=1e-6)
    rest = image[(off > 10.0) & (off < SIDE / 2)]
    assert PLAIN.fluid <= rest.min() < PLAIN.grey < rest.max() <= PLAIN.white + 1e-6


def test_a_shift_of_two_voxels_moves_the_image_by_two(
    brain: TetMesh, grid: ImageGrid, still: Scan
) -> None:
    whole = np.tile([2 * VOXEL, 0.0, -VOXEL], (brain.n_points, 1))
    moved = simulated_scan(brain, whole, grid, PLAIN)
    expected = np.roll(np.asarray(still.image.data), (2, -1), axis=(0, 2))
    np.testing.assert_allclose(np.asarray(moved.image.data), expected, atol=1e-5)


def test_where_the_tumour_was_is_fluid(brain: TetMesh, grid: ImageGrid) -> None:
    rest, _ = remove_region(brain, 1)
    scan = simulated_scan(rest, np.zeros_like(rest.points), grid, PLAIN)
    gone = away(grid) < 10.0
    np.testing.assert_allclose(np.asarray(scan.image.data)[gone], PLAIN.fluid)
    assert (np.asarray(scan.brain.data)[gone] == 1).all()


def test_contrast_bias_and_noise_are_as_stated(
    brain: TetMesh, grid: ImageGrid, still: Scan
) -> None:
    rest = np.zeros_like(brain.points)
    quiet = replace(INTRAOPERATIVE, bias=0.0, noise=0.0)
    other = np.asarray(simulated_scan(brain, rest, grid, quiet).image.data)
    inside = np.asarray(still.brain.data) > 0
    # the order of the tissues is the same, the distances are not
    fit = np.polyfit(np.asarray(still.image.data)[inside], other[inside], 1)
    left = other[inside] - np.polyval(fit, np.asarray(still.image.data)[inside])
    assert np.abs(left).max() > 0.05
    noisy = simulated_scan(brain, rest, grid, replace(quiet, noise=0.05), seed=1)
    difference = (np.asarray(noisy.image.data) - other)[inside]
    assert difference.std() == pytest.approx(0.05, rel=0.05)
    biased = simulated_scan(brain, rest, grid, replace(quiet, bias=0.1), seed=2)
    ratio = np.asarray(biased.image.data)[inside] / other[inside]
    assert 0.01 < ratio.std() < 0.3
    neighbours = np.abs(
        np.diff(np.asarray(biased.image.data) / np.where(inside, other, 1), axis=0)
    )
    assert neighbours[inside[1:] & inside[:-1]].max() < 0.05

from pathlib import Path

import numpy as np

from imaging.conftest import spot
from physgnn.geometry.image import Image, ImageGrid
from physgnn.imaging import before_after


def test_panels_show_before_after_and_both(oblique: ImageGrid, tmp_path: Path) -> None:
    centre = oblique.to_world([[25, 18, 14]])[0]
    before = spot(oblique, centre)
    after = Image(np.asarray(before.data) + 2.0, oblique.affine)
    figure = before_after(before, after, centre)
    titles = [axes.get_title() for axes in figure.axes]
    assert titles[:3] == [
        "sagittal, before",
        "sagittal, after",
        "sagittal, checkerboard",
    ]
    first, second, board = (
        np.asarray(axes.images[0].get_array()) for axes in figure.axes[:3]
    )
    # the planes meet at the spot, so its brightest voxel is on all of them
    assert first.max() > 0.9
    np.testing.assert_allclose(second, first + 2.0)
    from_first, from_second = board == first, board == second
    assert (from_first ^ from_second).all()
    figure.savefig(tmp_path / "slices.png")
    assert (tmp_path / "slices.png").stat().st_size > 10_000

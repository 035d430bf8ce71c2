"""The error of every point as images, by the stage and the command."""

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

import physgnn
from meshes import block_mesh
from physgnn.cli import main
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.io import write_mesh, write_prediction
from physgnn.io.medical.images.formats import read_image, write_image
from physgnn.io.vtk.error_fields import packed, read_error_fields

BODY = block_mesh(4, side=40.0)
AFFINE = np.diag([-2.0, 2.0, 2.0, 1.0])
AFFINE[:3, 3] = [48.0, -6.0, -6.0]
U = np.tile([0.0, 0.0, -4.0], (BODY.n_points, 1))


@pytest.fixture
def t1(tmp_path: Path) -> Path:
    write_image(tmp_path / "t1.nrrd", Image(np.ones((28, 27, 26)), AFFINE))
    return tmp_path / "t1.nrrd"


def centres(image: Image) -> np.ndarray:
    index = np.moveaxis(np.indices(image.data.shape), 0, -1)
    return index @ AFFINE[:3, :3].T + AFFINE[:3, 3]


def inside_of(x: np.ndarray, top: float = 40.0) -> np.ndarray:
    low = np.array([0.0, 0.0, top - 40.0])
    return ((x >= low) & (x <= [40.0, 40.0, top])).all(-1)


def test_deviation_and_probability_lie_where_the_brain_was(
    t1: Path, tmp_path: Path
) -> None:
    deviation = 0.5 + BODY.points[:, 2] / 10
    C = np.zeros((BODY.n_points, 3, 3))
    C[:, 0, 0] = deviation**2  # all of it along x
    fields = {
        "displacement_mm": U,
        "deviation_mm": deviation,
        "covariance_mm2": packed(C),
    }
    write_prediction(tmp_path / "shift.vtu", BODY, fields)
    said: list[str] = []
    made = physgnn.uncertainty(
        tmp_path / "shift.vtu",
        t1,
        tmp_path / "deviation",
        wrong=tmp_path / "wrong.nii.gz",
        wrong_mm=3.0,
        log=said.append,
    )
    found = read_image(tmp_path / "deviation.nrrd")
    x = centres(found)
    inside = inside_of(x)
    np.testing.assert_array_equal(made.inside, inside)
    wanted = np.where(inside, 0.5 + x[..., 2] / 10, 0.0)
    np.testing.assert_allclose(found.data, wanted, atol=1e-5)
    chance = read_image(tmp_path / "wrong.nii.gz").data
    np.testing.assert_allclose(found.affine, AFFINE)
    at_points = inside & (x[..., 2] % 10 == 0)
    deviation = wanted[at_points]
    np.testing.assert_allclose(
        chance[at_points], chi2.sf(9.0 / deviation**2, 1), atol=1e-5
    )
    assert (chance[~inside] == 0).all() and 0 <= chance.min() <= chance.max() <= 1
    assert "wrong by more than 3 mm:" in said[-1] and len(said) == 2


def test_over_a_warped_image_it_lies_where_the_brain_is(
    t1: Path, tmp_path: Path
) -> None:
    fields = {"displacement_mm": U, "deviation_mm": np.full(BODY.n_points, 2.0)}
    write_prediction(tmp_path / "shift.vtu", BODY, fields)
    said: list[str] = []
    physgnn.uncertainty(
        tmp_path / "shift.vtu",
        t1,
        tmp_path / "d.nii",
        wrong=tmp_path / "w.nii",
        deformed=True,
        log=said.append,
    )
    found = read_image(tmp_path / "d.nii")
    inside = inside_of(centres(found), top=36.0)
    np.testing.assert_allclose(found.data, np.where(inside, 2.0, 0.0), atol=1e-6)
    chance = read_image(tmp_path / "w.nii").data
    np.testing.assert_allclose(chance[inside], chi2.sf(3.0, 3), atol=1e-6)
    assert "Gaussian and alike in all directions" in said[0]


def test_register_writes_a_covariance_that_fits_its_deviation(tmp_path: Path) -> None:
    """Where the surface alone was measured, what slides within it is less certain."""
    body = block_mesh(4, side=80.0)
    write_mesh(tmp_path / "case.vtu", body)
    top = body.points[body.point_set("loaded")]
    np.savetxt(tmp_path / "s.csv", top - [0, 0, 3], delimiter=",")
    found = physgnn.register(
        tmp_path / "case.vtu", tmp_path / "u.vtu", surface=tmp_path / "s.csv"
    )
    read = read_error_fields(tmp_path / "u.vtu")
    C = read.covariance_mm2
    assert C is not None
    np.testing.assert_allclose(C, found.covariance_mm2)
    root = np.sqrt(np.trace(C, axis1=1, axis2=2))
    np.testing.assert_allclose(root, read.deviation_mm, atol=1e-9)
    middle = body.point_set("loaded")[12]
    assert C[middle, 2, 2] < 0.5 * min(C[middle, 0, 0], C[middle, 1, 1])
    assert (C[body.point_set("fixed")] == 0).all()


@pytest.mark.parametrize(
    ("fields", "words", "hint"),
    [
        ({}, (), "no probability at a point"),
        ({"deviation_mm": -np.ones(BODY.n_points)}, (), "must be ≥ 0"),
        ({"deviation_mm": np.full(BODY.n_points, np.nan)}, (), "must be finite"),
        ({"deviation_mm": U}, (), "must be finite, (125,) (got (125, 3))"),
        (
            {
                "deviation_mm": U[:, 0],
                "covariance_mm2": -np.ones((BODY.n_points, 6)),
            },
            (),
            "no covariance at point 0",
        ),
        ({"deviation_mm": U[:, 0]}, ("--wrong-mm", "0"), "of no use without --wrong"),
        (
            {"deviation_mm": U[:, 0]},
            ("--wrong", "w.nii", "--wrong-mm", "0"),
            "must be > 0 (got 0.0)",
        ),
        ({"deviation_mm": U[:, 0]}, ("--wrong", "d.nii"), "same file: name another"),
        ({"deviation_mm": U[:, 0]}, ("--wrong", "no/w.nii"), "folder no is not there"),
    ],
)
def test_mistakes_are_one_line_and_leave_nothing(
    fields: dict[str, np.ndarray],
    words: tuple[str, ...],
    hint: str,
    t1: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    write_prediction("u.vtu", BODY, {"displacement_mm": U, **fields})
    before = set(tmp_path.iterdir())
    command = ["physgnn", "uncertainty", "u.vtu", t1.name, "-o", "d.nii", *words]
    monkeypatch.setattr("sys.argv", command)
    with pytest.raises(SystemExit) as end:
        main()
    said = capsys.readouterr().err
    assert end.value.code == 2 and hint in said and "Traceback" not in said
    assert set(tmp_path.iterdir()) == before


def test_an_image_of_another_place_is_refused(tmp_path: Path) -> None:
    far = AFFINE.copy()
    far[:3, 3] = 900.0
    write_image(tmp_path / "far.nii", Image(np.ones((8, 8, 8)), far))
    fields = {"displacement_mm": U, "deviation_mm": np.ones(BODY.n_points)}
    write_prediction(tmp_path / "u.vtu", BODY, fields)
    with pytest.raises(InputError, match="do not meet"):
        physgnn.uncertainty(
            tmp_path / "u.vtu", tmp_path / "far.nii", tmp_path / "d.nii"
        )
    assert not (tmp_path / "d.nii").exists()

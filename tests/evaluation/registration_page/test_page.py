import re
from pathlib import Path

import numpy as np
import pytest

import physgnn
from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.evaluation.registration_page.case import RegisteredCase
from physgnn.evaluation.registration_page.figures import misfit_chart
from physgnn.evaluation.registration_page.page import misfit_table
from physgnn.evaluation.registration_page.places import MeasuredPlace, measured_places
from physgnn.geometry.image import Image
from physgnn.geometry.measured import BonePoints, PointPairs, SurfacePoints
from physgnn.imaging.slices import Overlay, overlaid
from physgnn.io import write_mesh
from physgnn.io.medical.images.formats import write_image
from physgnn.prediction.prediction import Prediction
from physgnn.prediction.status import PredictionStatus

BODY = block_mesh(4, side=80.0)
DOWN = np.tile([0.0, 0.0, -3.0], (BODY.n_points, 1))
TOP = BODY.points[BODY.point_set("loaded")]


def test_distances_before_and_after_of_pairs() -> None:
    source = TOP + np.array([0.0, 0.0, 0.5])  # a little above the surface
    target = source + np.array([0.0, 4.0, -3.0])
    found = measured_places(BODY, DOWN, PointPairs(source, target))
    assert [place.name for place in found][:2] == ["1", "2"]
    np.testing.assert_allclose([place.before_mm for place in found], 5.0)
    np.testing.assert_allclose([place.after_mm for place in found], 4.0, atol=1e-4)
    np.testing.assert_allclose(found[3].position_mm, target[3])


def test_distances_before_and_after_of_a_surface() -> None:
    inner = TOP[(TOP[:, :2] % 80 != 0).all(axis=1)]
    places = np.concatenate([inner, inner + np.array([1.0, 0.0, 0.0])]) - [
        0.0,
        0.0,
        4.0,
    ]
    found = measured_places(BODY, DOWN, SurfacePoints(places))
    np.testing.assert_allclose([place.before_mm for place in found], 4.0)
    np.testing.assert_allclose([place.after_mm for place in found], 1.0)


def test_places_of_several_measurements_follow_each_other() -> None:
    pairs, surface = PointPairs(TOP, TOP - [0, 0, 3]), SurfacePoints(TOP)
    found = measured_places(BODY, DOWN, [pairs, surface])
    assert [place.name for place in found] == [str(i + 1) for i in range(2 * len(TOP))]
    assert max(place.after_mm for place in found[: len(TOP)]) < 1e-9
    np.testing.assert_allclose([p.after_mm for p in found[len(TOP) :]], 3.0)


def test_distances_without_an_offset_of_the_navigation() -> None:
    away = np.array([0.0, 6.0, 8.0])
    bone = BonePoints(TOP[:4] + 9.0, TOP[:4] + 9.0 + away + [0.0, 0.0, 0.5])
    pairs = PointPairs(TOP, TOP - [0, 0, 3] + away)
    found = measured_places(BODY, DOWN, [pairs, bone], lambda points: points - away)
    brain, of_bone = found[: len(TOP)], found[len(TOP) :]
    np.testing.assert_allclose([place.before_mm for place in brain], 3.0)
    np.testing.assert_allclose([place.after_mm for place in brain], 0.0, atol=1e-9)
    np.testing.assert_allclose([p.before_mm for p in of_bone], np.hypot(6.0, 8.5))
    np.testing.assert_allclose([place.after_mm for place in of_bone], 0.5)


def case_of(*after: float, note: str = "") -> RegisteredCase:
    places = tuple(
        MeasuredPlace(f"p{i}", (1.0, 2.0, 3.0), 5.0, distance, note)
        for i, distance in enumerate(after)
    )
    status = PredictionStatus.OK
    ones = np.ones(BODY.n_points)
    return RegisteredCase(
        mesh=BODY,
        prediction=Prediction(DOWN, None, status, 0.1),
        deviation_mm=ones,
        covariance_mm2=ones[:, None, None] * np.eye(3),
        misfit_mm=1.0,
        held_out_mm=1.2,
        places=places,
        noise_mm=1.0,
    )


def test_the_table_has_the_farthest_first_and_says_how_many_there_are() -> None:
    table = misfit_table(case_of(1.0, 7.0, 3.0))
    assert [row[0] for row in table.rows] == ["p1", "p2", "p0"]
    assert len(table.columns) == len(table.rows[0]) == 6
    noted = misfit_table(case_of(1.0, note="outlier"))
    assert noted.columns[-1] == "note" and noted.rows[0][-1] == "outlier"
    many = misfit_table(case_of(*range(100)))
    assert len(many.rows) == 60 and "The 60 farthest of 100." in many.note


def test_the_chart_has_a_bar_a_place_or_a_distribution() -> None:
    few = misfit_chart(case_of(1.0, 2.0).places, 1.0).axes[0]
    assert [bar.get_height() for bar in few.patches] == [5.0, 5.0, 1.0, 2.0]
    many = misfit_chart(case_of(*range(50)).places, 1.0).axes[0]
    assert sum(bar.get_height() for bar in many.patches) == 100


def test_an_overlay_shows_its_values_where_it_should() -> None:
    affine = np.diag([-2.0, 2.0, 2.0, 1.0])
    values = np.random.default_rng(0).uniform(size=(8, 9, 10))
    shown = values > 0.5
    overlay = Overlay(values, shown, (0.0, 1.0), "viridis", "mm", fades=True)
    centre = (affine @ [4, 4, 5, 1])[:3]
    figure = overlaid(Image(values * 100, affine), overlay, centre)
    axial = figure.axes[2].images[1].get_array()
    upright = values[::-1, :, 5].T  # the first index runs to the left
    np.testing.assert_array_equal(axial.mask, upright <= 0.5)
    np.testing.assert_allclose(axial.compressed(), upright[upright > 0.5])


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_mesh("case.vtu", BODY)
    affine = np.diag([-4.0, 4.0, 4.0, 1.0])
    affine[:3, 3] = [90.0, -10.0, -10.0]
    image = Image(np.random.default_rng(0).uniform(size=(25, 25, 25)), affine)
    write_image("t1.nii", image)
    np.savetxt("m.csv", np.hstack([TOP, TOP - [0, 0, 3]]), delimiter=",")
    np.savetxt("few.csv", np.hstack([TOP, TOP - [0, 0, 3]])[:4], delimiter=",")
    return tmp_path


@pytest.mark.parametrize("image", [None, "t1.nii"])
def test_register_writes_one_page(folder: Path, image: str | None) -> None:
    found = physgnn.register(
        "case.vtu", "u.vtu", points="m.csv", image=image, report="page"
    )
    assert [file.name for file in (folder / "page").iterdir()] == ["report.html"]
    html = (folder / "page" / "report.html").read_text("utf-8")
    assert f"Registration: {found.prediction.status}" in html
    # four figures, each for a light and a dark page; nothing from elsewhere
    assert len(re.findall(r'(?:src|srcset)="data:image/png;base64', html)) == 8
    assert not re.findall(r'(?:src|href|srcset)="(?!data:)', html)
    for title in (
        "Status",
        "Before and after",
        "How far to trust it",
        "Misfit by point",
    ):
        assert f"{title}<" in html
    assert html.count("<tr class=") == len(TOP)


def test_what_is_not_ok_says_so_at_the_top_with_its_reasons(folder: Path) -> None:
    found = physgnn.register("case.vtu", "u.vtu", points="few.csv", report="page")
    html = (folder / "page" / "report.html").read_text("utf-8")
    assert '<body class="alert">' in html and found.prediction.reasons
    for reason in found.prediction.reasons:
        assert html.index(reason) < html.index("Before and after")


def test_a_page_that_cannot_be_written_is_said_before_the_work(folder: Path) -> None:
    Path("file").write_text("x")
    for report in ("file", "file/page"):
        with pytest.raises(InputError, match="must be a folder"):
            physgnn.register("case.vtu", "u.vtu", points="m.csv", report=report)
    assert not (folder / "u.vtu").exists()

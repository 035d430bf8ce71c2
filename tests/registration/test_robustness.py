"""Bad points, navigation that is off, several kinds at once; truth by the FE solver."""

from collections.abc import Callable

import numpy as np
import pytest
from block_shifts import (
    NOISE,
    errors,
    measured,
    seen_inside,
    seen_surface,
    true_shift,
)

from physgnn.geometry import boundary_surface
from physgnn.geometry.measured import (
    BonePoints,
    PointPairs,
    SurfacePoints,
    WholeSurface,
)
from physgnn.geometry.tetmesh import TetMesh
from physgnn.prediction import PredictionStatus
from physgnn.registration.misfits import write_misfits
from physgnn.registration.registrar import Registrar

SEEDS = range(3)


def astray(pairs: PointPairs, seed: int) -> PointPairs:
    """Move a tenth of the points by 15 mm in random directions."""
    rng = np.random.default_rng(seed)
    chosen = rng.choice(len(pairs.source), len(pairs.source) // 10, replace=False)
    away = rng.normal(size=(len(chosen), 3))
    target = pairs.target.copy()
    target[chosen] += 15.0 * away / np.linalg.norm(away, axis=1, keepdims=True)
    labels = ["bad" if i in chosen else "good" for i in range(len(target))]
    return PointPairs(pairs.source, target, tuple(labels))


def swapped(pairs: PointPairs) -> PointPairs:
    """Swap two points that lie far apart."""
    target = pairs.target.copy()
    target[[3, 20]] = target[[20, 3]]
    labels = ["bad" if i in (3, 20) else "good" for i in range(len(target))]
    return PointPairs(pairs.source, target, tuple(labels))


@pytest.fixture(scope="module")
def clean(body: TetMesh, registrar: Registrar) -> dict[int, float]:
    """Mean error of each seed where all points are good."""
    found = {}
    for seed in SEEDS:
        u = true_shift(body, seed, 10.0)
        good = registrar(measured(body, u, seed), noise_mm=NOISE)
        assert not good.outliers
        found[seed] = errors(good, u).mean()
    return found


@pytest.mark.parametrize("bad", ["astray", "swapped"])
def test_bad_points_are_named_and_cost_a_fifth_at_most(
    bad: str, body: TetMesh, registrar: Registrar, clean: dict[int, float]
) -> None:
    total = 0.0
    for seed in SEEDS:
        u = true_shift(body, seed, 10.0)
        pairs = measured(body, u, seed)
        spoilt = astray(pairs, seed) if bad == "astray" else swapped(pairs)
        found = registrar(spoilt, noise_mm=NOISE)
        assert {one.label for one in found.outliers} == {"bad"}
        assert len(found.outliers) == spoilt.labels.count("bad")
        assert min(one.distance_mm for one in found.outliers) > 8.0
        assert found.prediction.status == PredictionStatus.OK
        total += errors(found, u).mean()
    assert total < 1.2 * sum(clean.values())


def test_three_bad_points_of_eight_are_not_ok(
    body: TetMesh, registrar: Registrar
) -> None:
    for seed in SEEDS:
        pairs = measured(body, true_shift(body, seed, 10.0), seed)
        some = np.random.default_rng(seed).permutation(len(pairs.source))[:8]
        target = pairs.target[some].copy()
        target[:3] += 15.0 * np.random.default_rng(seed).normal(size=(3, 3))
        few = PointPairs(pairs.source[some], target)
        assert not registrar(few, noise_mm=NOISE).prediction.status.usable


def test_several_kinds_together_know_more_than_one(
    body: TetMesh, registrar: Registrar
) -> None:
    alone, together = 0.0, 0.0
    for seed in SEEDS:
        u = true_shift(body, seed, 10.0)
        surface, inside = seen_surface(body, u, seed), seen_inside(body, u, seed)
        noise = {"surface": NOISE, "landmarks": NOISE}
        alone += errors(registrar(surface, noise_mm=noise), u).mean()
        both = registrar([surface, inside], noise_mm=noise)
        together += errors(both, u).mean()
        kinds = [one.kind for one in both.misfits]
        assert kinds.count("landmarks") == 12 and kinds.count("surface") == 300
    assert together < 0.8 * alone


def test_a_whole_surface_tells_where_the_top_went(
    body: TetMesh, registrar: Registrar
) -> None:
    u = true_shift(body, 1, 10.0)
    outer = boundary_surface(body)
    used, faces = np.unique(outer.faces, return_inverse=True)
    seen = WholeSurface((body.points + u)[used], faces.reshape(-1, 3).astype(np.int64))
    found = registrar(seen, noise_mm=NOISE)
    top = body.point_set("loaded")
    assert found.offset.unknown_mm < 0.5
    assert found.prediction.status is PredictionStatus.OK
    lag = (found.prediction.displacement - u)[top, 2]
    assert np.abs(lag).mean() < 0.15 * np.abs(u[top, 2]).mean()


def test_a_navigation_that_is_off_by_8_mm_is_not_ok_and_can_be_corrected(
    body: TetMesh, registrar: Registrar
) -> None:
    """Landmarks deep in a block that its walls hold tell an offset from a shift."""
    u = true_shift(body, 0, 8.0)
    away = np.array([0.0, 4.8, 6.4])
    given = []
    for pairs in (measured(body, u, 0), seen_inside(body, u, 0)):
        given.append(type(pairs)(pairs.source, pairs.target + away))
    found = registrar(given, noise_mm=NOISE)
    assert found.prediction.status in (
        PredictionStatus.NAVIGATION_OFFSET,
        PredictionStatus.MOVED_AS_A_WHOLE,
        PredictionStatus.OFFSET_NOT_TOLD,
    )
    assert found.offset.probability > 0.5 and not found.offset.corrected
    better = registrar(given, noise_mm=NOISE, rigid_offset=True)
    assert better.offset.corrected
    assert errors(better, u).mean() < 0.6 * errors(found, u).mean()
    straight = registrar(
        [measured(body, u, 0), seen_inside(body, u, 0)], noise_mm=NOISE
    )
    assert straight.offset.probability < 0.5
    assert straight.prediction.status == PredictionStatus.OK


OUT, IN, ASIDE = (0, 0, 8.0), (0, 0, -8.0), (8.0, 0, 0)


# Not by landmarks alone: 8 mm in, all of them deep, look like a brain that sank.
@pytest.mark.parametrize(
    ("see", "way"),
    [(measured, way) for way in (OUT, IN, ASIDE)]
    + [(seen_inside, way) for way in (OUT, ASIDE)],
)
def test_a_tracker_that_moved_alone_is_named_or_bounded(
    see: Callable[..., PointPairs],
    way: tuple[float, float, float],
    body: TetMesh,
    registrar: Registrar,
) -> None:
    rest = np.zeros_like(body.points)
    pairs = see(body, rest, 0)
    off = type(pairs)(pairs.source, pairs.target + np.array(way))
    found = registrar(off, noise_mm=NOISE)
    bound = found.prediction.error_estimate_mm
    assert bound is not None
    wrong = errors(found, rest).max() > bound.max_mm
    assert not (wrong and found.prediction.status.usable)


@pytest.mark.parametrize("kind", ["pairs", "landmarks", "surface"])
@pytest.mark.parametrize("seed", range(2))
def test_a_tracker_that_hides_a_shift_is_never_silently_ok(
    kind: str, seed: int, body: TetMesh, registrar: Registrar
) -> None:
    """8 mm out while the brain sank: hardly anything seems to have moved."""
    u, out = true_shift(body, seed, 8.0), np.array([0.0, 0.0, 8.0])
    if kind == "surface":
        surface = seen_surface(body, u, seed)
        found = registrar(type(surface)(surface.points + out), noise_mm=NOISE)
    else:
        see = measured if kind == "pairs" else seen_inside
        pairs = see(body, u, seed)
        found = registrar(type(pairs)(pairs.source, pairs.target + out), noise_mm=NOISE)
    bound = found.prediction.error_estimate_mm
    assert bound is not None
    wrong = errors(found, u).max() > bound.max_mm
    assert not (wrong and found.prediction.status.usable)


@pytest.mark.parametrize("mm", [4.0, 8.0])
@pytest.mark.parametrize("see", [measured, seen_inside, seen_surface])
def test_a_tracker_that_adds_to_a_shift_is_never_just_ok(
    see: Callable[..., PointPairs | SurfacePoints],
    mm: float,
    body: TetMesh,
    registrar: Registrar,
) -> None:
    """Further in while the brain sank: it seems to have sunk more."""
    seen, away = see(body, true_shift(body, 1, 8.0), 1), np.array([0.0, 0.0, -mm])
    if isinstance(seen, SurfacePoints):
        found = registrar(SurfacePoints(seen.points + away), noise_mm=NOISE)
    else:
        given = type(seen)(seen.source, seen.target + away)
        found = registrar(given, noise_mm=NOISE)
    assert found.prediction.status is not PredictionStatus.OK
    assert found.offset.unknown_mm > 1.0


def test_exchanged_ends_are_not_ok(body: TetMesh, registrar: Registrar) -> None:
    """With bone they were: the offset is then known, and nothing looks odd."""
    u = true_shift(body, 1, 8.0)
    pairs = measured(body, u, 1)
    still = np.array([[0.0, 0, 120], [90, 0, 120], [0, 90, 120], [90, 90, 120]])
    bone = BonePoints(still, still + 0.01)
    assert registrar([pairs, bone], noise_mm=NOISE).prediction.status.usable
    turned = PointPairs(pairs.target, pairs.source)
    found = registrar([turned, bone], noise_mm=NOISE).prediction
    assert found.status is PredictionStatus.MEASUREMENT_TOO_FAR
    assert any("exchanged" in reason for reason in found.reasons)


def test_a_surface_that_bulges_is_told_from_nothing(
    body: TetMesh, registrar: Registrar
) -> None:
    seen = seen_surface(body, np.zeros_like(body.points), 0)
    out = type(seen)(seen.points + np.array([0, 0, 8.0]))
    found = registrar(out, noise_mm=NOISE).prediction
    assert not found.status.usable
    assert any("does not sink" in reason for reason in found.reasons)


def test_a_change_of_a_nanometre_changes_nothing(
    body: TetMesh, registrar: Registrar
) -> None:
    u = true_shift(body, 2, 10.0)
    rng = np.random.default_rng(0)
    surface, pairs = seen_surface(body, u, 2), astray(measured(body, u, 2), 2)
    nudged = [
        type(surface)(surface.points + 1e-6 * rng.normal(size=surface.points.shape)),
        PointPairs(pairs.source, pairs.target + 1e-6 * rng.normal(size=u[:1].shape)),
    ]
    one, other = (
        registrar(given, noise_mm=NOISE) for given in ([surface, pairs], nudged)
    )
    np.testing.assert_allclose(
        one.prediction.displacement, other.prediction.displacement, atol=1e-3
    )
    bounds = one.prediction.error_estimate_mm, other.prediction.error_estimate_mm
    assert bounds[0] is not None and bounds[1] is not None
    assert bounds[0].max_mm == pytest.approx(bounds[1].max_mm, rel=1e-3)


def test_misfits_are_a_table_that_a_spreadsheet_reads(
    body: TetMesh, registrar: Registrar, tmp_path
) -> None:
    pairs = swapped(measured(body, true_shift(body, 0, 10.0), 0))
    found = registrar(pairs, noise_mm=NOISE)
    write_misfits(tmp_path / "m.csv", found.misfits)
    table = np.genfromtxt(
        tmp_path / "m.csv", delimiter=",", names=True, dtype=None, encoding="utf-8"
    )
    assert len(table) == len(pairs.source)
    assert list(table["label"]) == list(pairs.labels)
    moved = pairs.source + found.prediction.displacement[body.point_set("loaded")]
    wanted = np.linalg.norm(moved - pairs.target, axis=1)
    np.testing.assert_allclose(table["distance_mm"], wanted, atol=0.02)
    assert table["weight"][[3, 20]].max() < 0.1 < np.median(table["weight"])

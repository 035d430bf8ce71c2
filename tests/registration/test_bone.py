"""With points of the bone a tracker that is off is no riddle any more."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from block_shifts import (
    MATERIALS,
    NOISE,
    SIDE,
    errors,
    measured,
    seen_inside,
    seen_surface,
    true_shift,
)
from scipy.spatial.transform import Rotation

from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.measured import BonePoints, PointPairs, WholeSurface
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.prediction import PredictionStatus
from physgnn.registration.measurements.bone import check_bone
from physgnn.registration.measurements.kinds import AnyMeasured, moved, parted
from physgnn.registration.registrar import Registrar
from physgnn.registration.result import Registration

BONE_NOISE = 0.5
NOISES = {"pairs": NOISE, "landmarks": NOISE, "surface": NOISE, "bone": BONE_NOISE}
RIM = np.array(
    [
        [-6.0, 20, 95],
        [-6, 80, 95],
        [106, 20, 95],
        [106, 80, 95],
        [50, -6, 80],
        [50, 106, 99],
    ]
)
OUT, IN, ASIDE = (0, 0, 8.0), (0, 0, -8.0), (8.0, 0, 0)


def bone(seed: int, offset: Sequence[float] = (0, 0, 0)) -> BonePoints:
    noise = BONE_NOISE * np.random.default_rng(seed).normal(size=RIM.shape)
    names = tuple(f"rim {i}" for i in range(len(RIM)))
    return BonePoints(RIM, RIM + np.array(offset) + noise, names)


def wrong(found: Registration, u: np.ndarray) -> bool:
    bound = found.prediction.error_estimate_mm
    assert bound is not None
    return bool(errors(found, u).max() > bound.max_mm)


@pytest.mark.parametrize("way", [OUT, IN, ASIDE])
@pytest.mark.parametrize("see", [measured, seen_inside, seen_surface])
def test_a_tracker_that_is_off_costs_nothing(
    see: Callable, way: tuple[float, ...], body: TetMesh, registrar: Registrar
) -> None:
    u = true_shift(body, 0, 8.0)
    clean = registrar([see(body, u, 0), bone(0)], noise_mm=NOISES)
    off = moved(see(body, u, 0), lambda points: points + way)
    found = registrar([off, bone(0, way)], noise_mm=NOISES)
    np.testing.assert_allclose(
        found.prediction.displacement, clean.prediction.displacement, atol=1e-4
    )
    assert found.offset.corrected and found.offset.probability > 0.99
    left = found.offset.undone(RIM + np.array(way)) - RIM
    assert np.abs(left).max() < 1.5  # about three times the noise of a point
    known = np.abs(found.offset.translation_mm - way) / found.offset.deviation_mm
    assert known.max() < 3.5
    assert not (wrong(found, u) and found.prediction.status.usable)
    assert found.prediction.status == clean.prediction.status


def test_a_brain_that_sank_and_a_tracker_that_is_farther_in_are_told_apart(
    body: TetMesh, registrar: Registrar
) -> None:
    for seed in range(3):
        u = true_shift(body, seed, 8.0)
        off = moved(measured(body, u, seed), lambda points: points + IN)
        found = registrar([off, bone(seed, IN)], noise_mm=NOISES)
        assert found.prediction.status == PredictionStatus.OK
        assert not wrong(found, u) and errors(found, u).max() < 4.0
        alone = registrar(off, noise_mm=NOISE)
        assert errors(alone, u).max() > 6.0 and alone.bone is None


def test_a_rigid_motion_of_everything_measured_changes_nothing(
    body: TetMesh, registrar: Registrar
) -> None:
    u = true_shift(body, 1, 8.0)
    turn = Rotation.from_rotvec([0.15, -0.1, 0.2])  # 15 degrees
    middle = np.full(3, SIDE / 2)

    def to(points: np.ndarray) -> np.ndarray:
        return turn.apply(points - middle) + middle + [6.0, -9.0, 4.0]

    given: list[AnyMeasured] = [
        measured(body, u, 1), seen_inside(body, u, 1), seen_surface(body, u, 1)
    ]  # fmt: skip
    here = registrar([*given, bone(1)], noise_mm=NOISES)
    there = registrar(
        [*(moved(one, to) for one in given), BonePoints(RIM, to(bone(1).target))],
        noise_mm=NOISES,
    )
    np.testing.assert_allclose(
        there.prediction.displacement, here.prediction.displacement, atol=1e-4
    )
    np.testing.assert_allclose(there.deviation_mm, here.deviation_mm, rtol=1e-4)
    assert there.prediction.status == here.prediction.status
    # the offset is the motion, after the one that noise seemed to be
    centre, small = there.offset.centre_mm, here.offset
    np.testing.assert_allclose(centre, small.centre_mm, atol=1e-6)
    wanted = to(centre + small.translation_mm) - centre
    np.testing.assert_allclose(there.offset.translation_mm, wanted, atol=1e-5)
    turned = turn * Rotation.from_rotvec(np.deg2rad(small.rotation_deg))
    found = np.deg2rad(there.offset.rotation_deg)
    np.testing.assert_allclose(found, turned.as_rotvec(), atol=1e-6)


def test_a_bad_bone_point_is_named_and_does_no_harm(
    body: TetMesh, registrar: Registrar
) -> None:
    u = true_shift(body, 2, 8.0)
    good = bone(2, IN)
    target = good.target.copy()
    target[4] += [0.0, 12.0, 5.0]
    off = moved(measured(body, u, 2), lambda points: points + IN)
    found = registrar([off, BonePoints(RIM, target, good.labels)], noise_mm=NOISES)
    assert [(one.kind, one.label) for one in found.outliers] == [("bone", "rim 4")]
    assert 11.0 < found.outliers[0].distance_mm < 15.0
    assert found.prediction.status == PredictionStatus.OK and not wrong(found, u)
    assert found.bone is not None and found.bone.n_points == 5
    assert [one.kind for one in found.misfits][-6:] == ["bone"] * 6


def test_bone_points_that_cannot_tell_or_do_not_agree_are_a_status(
    body: TetMesh, registrar: Registrar
) -> None:
    pairs = measured(body, true_shift(body, 0, 8.0), 0)
    line = RIM[0] + np.linspace(0, 1, 3)[:, None] * [0.0, 60.0, 0.0]
    for few in (line, RIM[:2]):
        two_ends = BonePoints(few, few + 0.01)
        found = registrar([pairs, two_ends], noise_mm=NOISES).prediction
        assert found.status == PredictionStatus.TOO_FEW_BONE_POINTS
    stretched = 1.1 * (RIM - 50.0) + 50.0
    found = registrar([pairs, BonePoints(RIM, stretched)], noise_mm=NOISES).prediction
    assert found.status == PredictionStatus.BONE_MISFIT
    assert any("bone points" in reason for reason in found.reasons)


def test_a_brain_that_rose_is_believed_where_bone_checked_the_tracker(
    body: TetMesh, registrar: Registrar
) -> None:
    u = -true_shift(body, 0, 8.0)
    pairs = measured(body, u, 0)
    alone = registrar(pairs, noise_mm=NOISE).prediction
    assert alone.status == PredictionStatus.OFFSET_NOT_TOLD
    found = registrar([pairs, bone(0)], noise_mm=NOISES)
    assert found.prediction.status == PredictionStatus.OK and not wrong(found, u)


BAD: dict[str, tuple[Callable[[], list[BonePoints]], str]] = {
    "in the brain": (
        lambda: [BonePoints(RIM * 0.5 + 25, RIM * 0.5 + 25)],
        "outside of",
    ),
    "far": (lambda: [BonePoints(RIM + 500.0, RIM + 500.0)], "within 200 mm"),
    "of another space": (lambda: [BonePoints(RIM, RIM + 60.0)], "--initial-transform"),
    "twice": (lambda: [bone(0), bone(1)], "as one"),
    "never measured": (lambda: [BonePoints(RIM, RIM)], "measured .* are the same"),
    "paired in another order": (
        lambda: [BonePoints(RIM, np.roll(RIM, 1, axis=0))],
        "order or labels",
    ),
}


@pytest.mark.parametrize("what", BAD)
def test_points_that_are_no_bone_are_refused(
    what: str, body: TetMesh, registrar: Registrar
) -> None:
    pairs = measured(body, np.zeros_like(body.points), 0)
    make, message = BAD[what]
    with pytest.raises(InputError, match=message):
        registrar([pairs, *make()], noise_mm=NOISES)


@pytest.mark.parametrize("unit", [10.0, 1000.0])
def test_points_in_another_unit_are_refused(unit: float, body: TetMesh) -> None:
    centred = replace(body, points=body.points - SIDE / 2)
    points = (RIM - SIDE / 2) / unit
    with pytest.raises(InputError, match=f"multiply them by {unit:g}"):
        check_bone(centred, BonePoints(points, points))
    with pytest.raises(InputError, match=f"navigation.*multiply them by {unit:g}"):
        check_bone(centred, BonePoints(RIM - SIDE / 2, points))


def test_bone_alone_says_nothing_of_a_brain(registrar: Registrar) -> None:
    with pytest.raises(InputError, match="of the brain"):
        registrar([bone(0)], noise_mm=NOISES)


def test_points_of_the_brain_are_no_bone_as_well(body: TetMesh) -> None:
    brain = PointPairs(RIM[:4] + 1.0, RIM[:4] + 2.0)
    parted(body, [brain, bone(0)])
    again = BonePoints(
        np.vstack([RIM, brain.source[1:2]]), np.vstack([RIM, brain.target[1:2]])
    )
    with pytest.raises(InputError, match="given as both"):
        parted(body, [brain, again])


def test_points_of_the_cortex_are_no_bone(body: TetMesh, registrar: Registrar) -> None:
    u = true_shift(body, 0, 8.0)
    pairs = measured(body, u, 0)
    taken, left = slice(None, None, 4), np.arange(len(pairs.source)) % 4 > 0
    cortex = BonePoints(pairs.source[taken], pairs.target[taken])
    rest = PointPairs(pairs.source[left], pairs.target[left])
    found = registrar([rest, cortex], noise_mm=NOISES)
    assert wrong(found, u)  # the bone takes out that the brain sank
    assert found.prediction.status == PredictionStatus.BONE_MISFIT
    assert any("no bone" in reason for reason in found.prediction.reasons)


@pytest.mark.parametrize("side", [0.0, 8.0])
def test_bone_that_could_be_of_other_axes_leaves_the_navigation_to_the_user(
    side: float, body: TetMesh
) -> None:
    """Where the head lies about the origin, nothing but the user tells RAS from LPS."""
    middle = np.array([SIDE / 2, SIDE / 2, 0.0])
    centred = replace(body, points=body.points - middle)
    registrar = Registrar(Body(centred, MATERIALS))
    pairs = measured(body, true_shift(body, 0, 8.0), 0)
    told = bone(0, (side, 0.0, 0.0))
    to = [side, 0.0, 0.0] - middle
    seen = PointPairs(pairs.source - middle, pairs.target + to)
    found = registrar(
        [seen, BonePoints(told.source - middle, told.target - middle)], noise_mm=NOISES
    )
    assert found.bone is not None
    assert found.bone.other_axes_mm == pytest.approx(2 * side, abs=1.0)
    status = found.prediction.status
    if side:
        assert status == PredictionStatus.OK_IF_NAVIGATION_IS_RIGHT
        assert "LPS" in found.prediction.reasons[0]
    else:
        assert status == PredictionStatus.OK


def test_bone_in_a_file_that_states_its_axes_is_no_riddle(body: TetMesh) -> None:
    middle = np.array([SIDE / 2, SIDE / 2, 0.0])
    centred = Body(replace(body, points=body.points - middle), MATERIALS)
    off = np.array([8.0, 0.0, 0.0])
    pairs = measured(body, true_shift(body, 0, 8.0), 0)
    seen = PointPairs(pairs.source - middle, pairs.target + off - middle)
    told = bone(0, (8.0, 0.0, 0.0))
    known = BonePoints(told.source - middle, told.target - middle, axes_known=True)
    found = Registrar(centred)([seen, known], noise_mm=NOISES)
    assert found.prediction.status == PredictionStatus.OK


def test_a_whole_surface_contradicts_bone_whose_ends_are_exchanged(
    body: TetMesh, registrar: Registrar
) -> None:
    u = true_shift(body, 0, 8.0)
    faces = boundary_faces(body)
    used, of_used = np.unique(faces, return_inverse=True)
    noise = NOISE * np.random.default_rng(0).normal(size=(len(used), 3))
    off = np.array([6.0, 0.0, 0.0])
    whole = WholeSurface(
        (body.points + u)[used] + noise + off, of_used.reshape(faces.shape)
    )
    good = bone(0, (6.0, 0.0, 0.0))
    noises = {**NOISES, "whole surface": NOISE}
    assert registrar([whole, good], noise_mm=noises).prediction.status.usable
    exchanged = BonePoints(good.target, good.source)
    found = registrar([whole, exchanged], noise_mm=noises)
    assert found.prediction.status == PredictionStatus.BONE_MISFIT
    assert found.bone is not None and found.bone.contradicted_mm > 3.0
    assert any("exchanged" in reason for reason in found.prediction.reasons)

"""How often a registration's status is wrong, on good and on bad measurements.

    OMP_NUM_THREADS=1 python benchmarks/registration_statuses.py --cases 12

The shifts are those of `physgnn.evaluation.in_silico.shifts`. Each is measured well,
and then badly in every way of `BAD`: too few points, one point many times, points in a
line or a cluster, pairs swapped or gone astray, a tracker that moved, a surface far
away or in other units, a noise stated far too small. What a tracker may have moved is
measured once more with 6 points of the bone around the craniotomy, of 0.5 mm of noise.

A registration is *wrong* if its largest error is above its bound. Counted are the
registrations that are wrong and called ok, those that are right and flagged, and how
far a misplaced tracker may be off unseen (median of a standard deviation); a refusal is
neither. What the log has is not registered again. Prints Markdown.
"""

import argparse
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from held_out import Log
from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.evaluation.in_silico.cases import BONE_NOISE_MM, N_BONE, Case
from physgnn.evaluation.in_silico.compared import TOLD_MM, Compared
from physgnn.evaluation.in_silico.shifts import Truth
from physgnn.geometry.measured import (
    BonePoints,
    PointPairs,
    SurfacePoints,
    WholeSurface,
)
from physgnn.prediction import PredictionStatus
from physgnn.registration.measurements.bone import LPS
from tables import machine, table

KINDS = ("pairs", "surface", "whole surface")
IF_RIGHT = PredictionStatus.OK_IF_NAVIGATION_IS_RIGHT
Measured = PointPairs | SurfacePoints | WholeSurface
Given = Measured | list[Measured | BonePoints]
USUAL = 40  # pairs, of the 50 there are
LINE_MM = 20.0  # of bone points in one
OFF_HEAD_MM = 3.0  # at least, from the brain to bone that was given in LPS
STRAY_MM = 15.0  # each coordinate of a bad point


def _some(case: Case, chosen: IntArray | slice | list[int]) -> PointPairs:
    return PointPairs(case.pairs.source[chosen], case.pairs.target[chosen])


def _direction(case: Case, name: str) -> FloatArray:
    """Return a unit vector out of the exposed surface, into it, or along it."""
    around = case.pairs.source - case.pairs.source.mean(axis=0)
    out = np.linalg.svd(around)[2][2]
    out *= np.sign(out[2])  # the bundled craniotomy looks up
    return {"out": out, "in": -out, "side": np.linalg.svd(around)[2][0]}[name]


def first(count: int, case: Case) -> Measured:
    return _some(case, slice(count))


def repeated(places: int, case: Case) -> Measured:
    return _some(case, np.tile(np.arange(places), 10))


def in_a_line(case: Case) -> Measured:
    around = case.pairs.source - case.pairs.source.mean(axis=0)
    across = around @ np.linalg.svd(around)[2][1]
    return _some(case, np.argsort(np.abs(across))[:8])


def clustered(case: Case) -> Measured:
    distance = np.linalg.norm(case.pairs.source - case.pairs.source[0], axis=1)
    return _some(case, np.argsort(distance)[:8])


def swapped(case: Case) -> Measured:
    pairs = _some(case, slice(USUAL))
    target = pairs.target.copy()
    target[[3, 20]] = target[[20, 3]]
    return PointPairs(pairs.source, target)


def astray(case: Case) -> Measured:
    pairs = _some(case, slice(USUAL))
    target = pairs.target.copy()
    random = np.random.default_rng(0)
    target[[3, 20, 30]] += STRAY_MM * random.normal(size=(3, 3))
    return PointPairs(pairs.source, target)


def tracker(mm: float, where: str, case: Case) -> Measured:
    """Move the tracker alone: the brain is where it was."""
    source = case.pairs.source
    noise = TOLD_MM * np.random.default_rng(0).normal(size=source.shape)
    return PointPairs(source, source + mm * _direction(case, where) + noise)


def both(mm: float, where: str, case: Case) -> Measured:
    """Add the tracker's motion to the brain's."""
    away = mm * _direction(case, where)
    return PointPairs(case.pairs.source, case.pairs.target + away)


def away(mm: float, where: str, case: Case) -> Measured:
    return SurfacePoints(case.surface.points + mm * _direction(case, where))


def scaled(by: float, case: Case) -> Measured:
    return SurfacePoints(case.surface.points * by)


def with_bone(way: Callable[[Case], Measured], case: Case) -> Given:
    """Add points of the bone, off by as much as the tracker is."""
    arguments = way.args if isinstance(way, partial) else ()
    off = len(arguments) == 2  # how far, and where to
    offset = arguments[0] * _direction(case, arguments[1]) if off else np.zeros(3)
    return [way(case), BonePoints(case.bone.source, case.bone.target + offset)]


def bone_swapped(case: Case) -> Given:
    target = case.bone.target[[1, 0, *range(2, N_BONE)]]
    return [case.pairs, BonePoints(case.bone.source, target)]


def bone_in_a_line(case: Case) -> Given:
    first, second = case.bone.source[:2]
    out = first - case.whole.points.mean(axis=0)
    along = np.cross(out, second - first)  # so that it does not dip into the brain
    along /= np.linalg.norm(along)
    line = first + np.linspace(0.0, LINE_MM, 3)[:, None] * along
    noise = case.bone.displacement[:3]
    return [case.pairs, BonePoints(line, line + noise)]


def cortex_for_bone(case: Case) -> Given:
    """Take every eighth pair of the cortex for bone."""
    some = slice(None, None, 8)
    taken = BonePoints(case.pairs.source[some], case.pairs.target[some])
    return [_some(case, [i for i in range(len(case.pairs.source)) if i % 8]), taken]


def bone_in_lps(mm: float, where: str, case: Case) -> Given:
    """Add a tracker that is off, and bone in LPS that could be bone in RAS as well."""
    pairs, bone = with_bone(partial(both, mm, where), case)
    middle = case.whole.points.mean(axis=0)
    out = bone.source - middle
    away = out / np.linalg.norm(out, axis=1, keepdims=True)
    in_lps = bone.source.copy()
    while not (off := _off_head(case, in_lps * LPS) > OFF_HEAD_MM).all():
        in_lps[~off] += away[~off]
    return [pairs, BonePoints(in_lps * LPS, (in_lps + bone.displacement) * LPS)]


def _off_head(case: Case, points: FloatArray) -> FloatArray:
    """Return how much farther from the head's middle points are than its surface."""
    head = case.whole.points
    nearest = head[cKDTree(head).query(points)[1]]
    far = [np.linalg.norm(p - head.mean(axis=0), axis=1) for p in (points, nearest)]
    return far[0] - far[1]


GOOD: Mapping[str, Callable[[Case], Measured]] = {
    "50 pairs": lambda case: case.pairs,
    "20 pairs": partial(first, 20),
    "10 pairs": partial(first, 10),
    "surface": lambda case: case.surface,
    "whole surface": lambda case: case.whole,
}
BAD: Mapping[str, Callable[[Case], Measured]] = {
    "3 pairs": partial(first, 3),
    "5 pairs": partial(first, 5),
    "one pair ten times": partial(repeated, 1),
    "3 pairs ten times": partial(repeated, 3),
    "8 pairs in a line": in_a_line,
    "8 pairs in a cluster": clustered,
    "two of 40 pairs swapped": swapped,
    "three of 40 pairs astray": astray,
    "tracker moved 8 mm, out": partial(tracker, 8.0, "out"),
    "tracker moved 8 mm, aside": partial(tracker, 8.0, "side"),
    "shift, and tracker moved 8 mm, in": partial(both, 8.0, "in"),
    "shift, and tracker moved 8 mm, out": partial(both, 8.0, "out"),
    "surface 8 mm off, out": partial(away, 8.0, "out"),
    "surface 8 mm off, in": partial(away, 8.0, "in"),
    "surface 15 mm off, out": partial(away, 15.0, "out"),
    "surface 15 mm off, in": partial(away, 15.0, "in"),
    "surface in cm": partial(scaled, 0.1),
    "surface in m": partial(scaled, 0.001),
}
NOISE_TOLD_MM = {"noise stated 10 times too small": 0.1 * TOLD_MM}
STILL = ("tracker moved 8 mm, out", "tracker moved 8 mm, aside")
WITH_BONE = f", {N_BONE} bone points"
"""After the name of a way: the same with them."""
CHECKED = (*GOOD, *(name for name in BAD if " off, " in name or "tracker" in name))
BAD_BONE: Mapping[str, Callable[[Case], Given]] = {
    "50 pairs, two of 6 bone points swapped": bone_swapped,
    "50 pairs, 3 bone points in a line": bone_in_a_line,
    "44 pairs, 6 others given as bone": cortex_for_bone,
    "shift, tracker moved 8 mm, aside, bone in LPS": partial(bone_in_lps, 8.0, "side"),
    "shift, tracker moved 4 mm, aside, bone in LPS": partial(bone_in_lps, 4.0, "side"),
    "shift, tracker moved 2 mm, aside, bone in LPS": partial(bone_in_lps, 2.0, "side"),
}


def measure(body: Compared, name: str, measured: Given, truth: FloatArray) -> dict:
    """Return what one registration says and how wrong it is."""
    told = NOISE_TOLD_MM.get(name, TOLD_MM)
    noise = {**dict.fromkeys(KINDS, told), "bone": BONE_NOISE_MM}
    try:
        registered = body.registrar(measured, noise_mm=noise)
    except InputError:
        return {"status": "refused"}
    found = registered.prediction
    error = np.linalg.norm(body.at_truth(found.displacement) - truth, axis=1).max()
    assert found.error_estimate_mm is not None
    return {
        "status": found.status.name,
        "error": float(error),
        "bound": found.error_estimate_mm.max_mm,
        "moved": float(np.linalg.norm(found.displacement, axis=1).max()),
        "reasons": list(found.reasons),
        "unknown": registered.offset.unknown_mm,
    }


def row(name: str, records: list[dict[str, Any]]) -> tuple[str, ...]:
    made = [r for r in records if r["status"] != "refused"]
    ended = [PredictionStatus[r["status"]] for r in made]
    wrong = [r["error"] > r["bound"] for r in made]
    pairs = list(zip(ended, wrong, strict=True))
    unknown = [r["unknown"] for r in made]
    statuses = Counter(r["status"].lower().replace("_", " ") for r in records)
    return (
        name,
        str(len(records)),
        str(sum(wrong)),
        str(sum(s is IF_RIGHT and w for s, w in pairs)),
        str(sum(s.usable and s is not IF_RIGHT and w for s, w in pairs)),
        str(sum(not s.usable and not w for s, w in pairs)),
        f"{np.median(unknown):.1f}" if unknown else "",
        ", ".join(f"{n} {status}" for status, n in statuses.most_common()),
    )


def rows(log: Log) -> Iterator[tuple[str, ...]]:
    checked = (f"{name}{WITH_BONE}" for name in CHECKED)
    for name in (*GOOD, *NOISE_TOLD_MM, *BAD, *checked, *BAD_BONE):
        if records := log.of(name):
            yield row(name, records)


def all_ways() -> dict[str, Callable[[Case], Given]]:
    """Return every way to measure a shift."""
    alone = {**GOOD, **dict.fromkeys(NOISE_TOLD_MM, GOOD["50 pairs"]), **BAD}
    checked = {
        f"{name}{WITH_BONE}": partial(with_bone, alone[name]) for name in CHECKED
    }
    return {**alone, **checked, **BAD_BONE}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--log", type=Path, default=Path("registration-statuses.jsonl"))
    parser.add_argument("--cases", type=int, default=12)
    parser.add_argument("--points", type=int, default=2000)
    parser.add_argument("--first-seed", type=int, default=400)
    options = parser.parse_args()
    print(machine())
    truth, log = Truth(int(1.5 * options.points), "fixed"), Log(options.log)
    body = Compared(options.points, "fixed", truth.mesh.points, causes=None)
    ways = all_ways()
    for seed in range(options.first_seed, options.first_seed + options.cases):
        missing = [n for n in ways if list(log.missing([(seed, 0)], n))]
        case = truth.case(seed) if missing else None
        for name in missing:
            assert case is not None
            still = name.removesuffix(WITH_BONE) in STILL
            u = np.zeros_like(case.displacement) if still else case.displacement
            said = measure(body, name, ways[name](case), u)
            log.add(path=seed, level=1, what=name, **said)
    wrong = ("wrong", "wrong, ok if navigation is right", "wrong and ok")
    head = ("measured", "cases", *wrong, "right and flagged", "tracker unknown, mm")
    table((*head, "ended"), rows(log))


if __name__ == "__main__":
    main()
